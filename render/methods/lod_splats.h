// Renders the scene from an LOD cut, no finer than blur and acuity can show. Every method with
// level of detail goes through this class.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "render/gl/splats.h"
#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

namespace foci {

struct LodSettings {
  CutSettings cut;
  int sub_apertures = 1;     ///< used where surfaces overlap; 1: a whole-aperture pass everywhere
  float low_pass_px = 0.0f;  ///< standard deviation of the low-pass that `cut` is made for
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

  /// @param frame  has the view's size, and depth where the settings ask for depth
  /// @return the stats without the time
  RenderStats render(const View& view, const RenderSettings& settings, const LodSettings& lod,
                     Frame& frame);

 private:
  RenderStats renderOnGpu(const View& view, const RenderSettings& settings, const LodSettings& lod,
                          Frame& frame);

  std::shared_ptr<const MomentTree> tree_;
  std::optional<GpuSplats> gpu_;
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
};

}  // namespace foci
