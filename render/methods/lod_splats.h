// Renders the scene from an LOD cut, no finer than blur and acuity can show. Every method with
// level of detail goes through this class.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "render/gl/splats.h"
#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/splat.h"
#include "render/splat/sweep.h"

namespace foci {

struct LodSettings {
  CutSettings cut;
  /// Used where surfaces overlap; 1: a whole-aperture pass everywhere. A lens whose parts see
  /// different images (`Pupil::hasParts`) takes this many, or more, over the whole image.
  int sub_apertures = 1;
  float low_pass_px = 0.0f;  ///< standard deviation of the low-pass that `cut` is made for
  bool sharp = false;        ///< render without blur
  /// Render the mean of what these see instead; diffraction then widens the prefilter of each.
  std::vector<LensPart> parts = {};
  /// On the CPU a larger cut is rendered strip by strip, each of its own cut: a splat takes about
  /// 150 bytes.
  std::size_t max_splats = std::size_t{4} << 20;
};

/// Keeps its buffers between frames.
class LodSplats {
 public:
  /// @param gpu  renders; null: the CPU does
  explicit LodSplats(const SurfelCloud& cloud, const SharedGpu& gpu = nullptr);
  /// Shares the other's scene.
  LodSplats(const LodSplats& other, std::nullptr_t);
  /// On the CPU. @param tree  of a scene that outlives this
  explicit LodSplats(std::shared_ptr<const MomentTree> tree) : tree_(std::move(tree)) {}

  const std::shared_ptr<const MomentTree>& tree() const { return tree_; }
  bool isOnGpu() const { return gpu_ != nullptr; }

  /// Leaves the pixels on the GPU, if it renders.
  /// @param frame  has the view's size, and depth where the settings ask for depth
  /// @return the stats without the time
  RenderStats render(const View& view, const RenderSettings& settings, const LodSettings& lod,
                     Frame& frame);

  /// What one part of the lens sees.
  RenderStats renderPart(const View& view, const RenderSettings& settings, const LodSettings& lod,
                         const LensPart& part, Frame& frame);

 private:
  /// What the splats of a frame and their tiles depend on.
  struct Binned {
    View view;
    Defocus defocus;
    CutSettings cut;
    Projection projection;
    bool coarse() const { return projection.margin_px > 0; }
  };
  RenderStats renderLens(const View& view, const RenderSettings& settings, const LodSettings& lod,
                         Frame& frame);
  /// The mean of what the parts of the lens see, each in a pass of its own.
  RenderStats renderParts(const View& view, const RenderSettings& settings, const LodSettings& lod,
                          Frame& frame);
  GpuRequest gpuRequest(const View& view, const RenderSettings& settings,
                        const LodSettings& lod) const;
  /// @param projection  without acuity and margin
  static Binned binnedOf(const View& view, const Defocus& defocus, const CutSettings& cut,
                         Projection projection);
  void binCut(const Binned& wanted);
  std::uint64_t sweepTiles(const Binned& of, const LodSettings& lod, SweepSettings settings,
                           Frame& frame);
  /// On the CPU. @param settings  without lens and sub-apertures
  RenderStats renderSplats(const Binned& of, const LodSettings& lod, const SweepSettings& settings,
                           Frame& frame);

  std::shared_ptr<const MomentTree> tree_;
  std::unique_ptr<GpuSplats> gpu_;
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
  Frame part_, strip_;
};

}  // namespace foci
