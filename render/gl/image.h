// A frame in the GPU's memory.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "render/gl/buffer.h"
#include "render/image/frame.h"

namespace foci {

/// Buffers of an image. The device keeps those that no image has, for the next image of that size.
struct GpuImageBuffers {
  glm::ivec2 size_px{0};
  bool depth = false;
  GpuBuffer pixels, depths;            // as `Frame`: linear RGB and coverage; metres
  GpuBuffer host_pixels, host_depths;  // copies that the CPU reads
};

/// The pixels of a frame, and its depths. They do not change once they are rendered.
class GpuImage {
 public:
  /// Needs a `GpuDevice::Use`, as all that does not say otherwise. Throws GpuError without memory.
  GpuImage(std::shared_ptr<GpuDevice> device, const glm::ivec2& size_px, bool depth);
  /// Needs no use.
  ~GpuImage();
  GpuImage(const GpuImage&) = delete;
  GpuImage& operator=(const GpuImage&) = delete;

  const std::shared_ptr<GpuDevice>& device() const { return device_; }
  glm::ivec2 size_px() const { return buffers_->size_px; }
  bool hasDepth() const { return buffers_->depth; }
  const GpuImageBuffers& buffers() const { return *buffers_; }

  /// Begins to copy the image to the CPU's memory, and does not wait.
  void startRead();
  /// Waits for the copy. Throws GpuError where the GPU fails.
  void finishRead();
  /// After `finishRead`. Any thread may call it, without a use.
  void copyTo(Frame& frame) const;

  /// Adds `share` times `image`, channel by channel; or replaces this image by that.
  /// @param image  of the same size
  void add(const GpuImage& image, const glm::vec4& share, bool replaces);

 private:
  std::shared_ptr<GpuDevice> device_;
  std::shared_ptr<GpuImageBuffers> buffers_;
  void* copied_ = nullptr;  // fence
};

/// Brings the frame's pixels from the GPU to the frame, if they lie there. Takes a use itself.
/// Throws GpuError where the GPU fails.
void readFromGpu(Frame& frame);

/// Adds to `sum`, on the GPU, `share` times a frame that lies there. Takes a use itself.
/// @param first  replaces the sum
void addOnGpu(const Frame& frame, const glm::vec4& share, bool first, Frame& sum);

}  // namespace foci
