// Renders a scene on the GPU: LOD cut, projection, tiles, layers and sub-apertures, all as the CPU
// does in render/lod and render/splat. Both give the same image to rounding (docs/gpu.md).
#pragma once

#include <memory>
#include <utility>

#include "render/gl/buffer.h"
#include "render/gl/frame_stages.h"
#include "render/gl/image.h"
#include "render/gl/scene.h"

namespace foci {

/// Keeps its buffers between frames.
class GpuSplats {
 public:
  explicit GpuSplats(std::shared_ptr<const GpuScene> scene)
      : scene_(std::move(scene)), device_(scene_->device()), stages_(device_) {}

  /// Renders into `image`, a new one. Throws GpuError where the GPU fails or lacks memory. The same
  /// request gives the same bytes on one device and driver.
  GpuStats render(const GpuRequest& request, std::shared_ptr<GpuImage>& image);

  const std::shared_ptr<const GpuScene>& scene() const { return scene_; }

 private:
  struct Buffers {
    GpuBuffer outside;
    GpuBuffer bounds;                               // of the cut
    GpuBuffer splats_a, splats_b, lenses, sharper;  // by entry
    GpuBuffer overlaps;                             // by tile
    GpuBuffer centres;
  };

  void start(const GpuRequest& request);
  void makeRoom(const GpuRequest& request);
  void selectCut();
  void project();
  void sweep(const GpuRequest& request);

  std::shared_ptr<const GpuScene> scene_;
  std::shared_ptr<GpuDevice> device_;
  GpuFrameStages stages_;
  Buffers own_;
  bool cut_ = false, lens_ = false, astigmatic_ = false, by_sub_apertures_ = false;
  bool bodies_ = false;
};

}  // namespace foci
