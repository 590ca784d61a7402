// A frame as a texture of the GPU, for a window whose context shares the device's objects.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>

#include "render/gl/image.h"

namespace foci {

/// Where a frame shows an image, and how much of it.
struct GpuLayer {
  std::shared_ptr<GpuImage> image;
  glm::ivec2 corner_px{0};
  int columns = 0;        ///< from the left
  int white_column = -1;  ///< none
  glm::bvec3 channels{true};
};

struct GpuTextureStorage;

/// 8 bits a channel, the first row at the top.
class GpuTexture {
 public:
  /// Needs a `GpuDevice::Use`. Throws GpuError where the GPU fails.
  /// @param layers  in their order
  /// @param gamma   as `codesOf`
  GpuTexture(std::shared_ptr<GpuDevice> device, const glm::ivec2& size_px,
             std::span<const GpuLayer> layers, std::optional<double> gamma);
  /// Any thread may, without a use.
  ~GpuTexture();
  GpuTexture(const GpuTexture&) = delete;
  GpuTexture& operator=(const GpuTexture&) = delete;

  glm::ivec2 size_px() const;

  // In the window's context, each time the window shows the texture:
  unsigned beginShow();  ///< @return the texture's name. Later commands wait for its pixels.
  void endShow();        ///< The texture may be overwritten after the commands so far.

 private:
  std::shared_ptr<GpuDevice> device_;
  std::shared_ptr<GpuTextureStorage> storage_;
};

}  // namespace foci
