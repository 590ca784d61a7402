// Renders the scene from an LOD cut, no finer than blur and acuity can show. Every method with
// level of detail goes through this class.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
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

  const MomentTree& tree() const { return *tree_; }
  bool isOnGpu() const { return gpu_.has_value(); }

  /// Leaves the pixels on the GPU, if it renders.
  /// @param frame  has the view's size, and depth where the settings ask for depth
  /// @return the stats without the time
  RenderStats render(const View& view, const RenderSettings& settings, const LodSettings& lod,
                     Frame& frame);

  /// Begins a frame: renders only the tiles that these windows meet. Other pixels stay as they are.
  /// Calls of `renderWindows` and `render` for the same frame that follow use the same splats, and
  /// render only further tiles.
  /// @param frame  the same object each time, which nothing else writes to until `forgetWindows`
  /// @return false: nothing is rendered, because a GPU renders, the lens has parts, or the cut is
  ///         larger than `lod.max_splats`
  bool renderWindows(const View& view, const RenderSettings& settings, const LodSettings& lod,
                     std::span<const Window> windows, Frame& frame);
  void forgetWindows() { begun_.reset(); }

 private:
  /// What the splats of a frame and their tiles depend on.
  struct Binned {
    View view;
    Defocus defocus;
    CutSettings cut;
    Projection projection;
    bool coarse() const { return projection.margin_px > 0; }
    bool operator==(const Binned&) const = default;
  };
  /// What its pixels depend on, too, and where they are.
  struct Swept {
    int sub_apertures;
    glm::vec3 background;
    float low_pass_px;
    bool depth;
    const Frame* frame;
    bool operator==(const Swept&) const = default;
  };
  /// A frame that `renderWindows` began.
  struct Begun {
    Binned of;
    Swept by;
    std::vector<std::uint8_t> rendered;  ///< by tile
    std::uint64_t fragments = 0;         ///< of these tiles
  };
  RenderStats renderLens(const View& view, const RenderSettings& settings, const LodSettings& lod,
                         Frame& frame);
  /// Each sub-aperture in a whole-aperture pass of its own.
  RenderStats renderParts(const View& view, const RenderSettings& settings, const LodSettings& lod,
                          Frame& frame);
  GpuRequest gpuRequest(const View& view, const RenderSettings& settings,
                        const LodSettings& lod) const;
  /// @param projection  without acuity and margin
  static Binned binnedOf(const View& view, const Defocus& defocus, const CutSettings& cut,
                         Projection projection);
  /// Bins the splats of a frame, unless it is begun.
  /// @return false: the cut is larger than `max_splats`
  bool bin(const Binned& wanted, std::size_t max_splats);
  void binCut(const Binned& wanted);
  /// Renders tiles of the binned splats; null: all.
  std::uint64_t sweepTiles(const Binned& of, const LodSettings& lod, SweepSettings settings,
                           const std::vector<std::uint32_t>* tiles, Frame& frame);
  /// The same without those that are rendered already.
  void goOn(const LodSettings& lod, const SweepSettings& settings, std::vector<std::uint32_t> tiles,
            Frame& frame);
  /// On the CPU. @param settings  without lens and sub-apertures
  RenderStats renderSplats(const Binned& of, const LodSettings& lod, const SweepSettings& settings,
                           Frame& frame);

  std::shared_ptr<const MomentTree> tree_;
  std::optional<GpuSplats> gpu_;
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
  std::optional<Begun> begun_;
  Frame part_, strip_;
};

}  // namespace foci
