// Renders a scene on the GPU: LOD cut, projection, tiles, layers and sub-apertures, all as the CPU
// does in render/lod and render/splat. Both give the same image to rounding (docs/gpu.md).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "render/gl/image.h"
#include "render/gl/scene.h"
#include "render/gl/stages.h"
#include "render/image/frame.h"
#include "render/lod/cut.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

struct GpuRequest {
  View view;
  Defocus defocus;
  std::optional<CutSettings> cut;  ///< absent: every surfel, at full detail
  Acuity acuity = {};              ///< width of the prefilter without a cut, which has its own
  glm::vec2 lens{0.0f};            ///< `Projection::lens`
  float aperture = 1.0f;           ///< `Projection::aperture`
  float shading = 0.0f;
  glm::vec3 background{0.0f};
  bool depth = false;
  float low_pass_px = 0.0f;                     ///< of `SweepSettings`
  std::vector<glm::vec2> sub_aperture_centres;  ///< lens radii; up to one: none
};

struct GpuStats {
  std::uint64_t splats = 0, fragments = 0;
  GpuTimes times;
};

/// Keeps its buffers between frames.
class GpuSplats {
 public:
  explicit GpuSplats(std::shared_ptr<const GpuScene> scene);
  ~GpuSplats();
  GpuSplats(GpuSplats&&) noexcept;
  GpuSplats& operator=(GpuSplats&&) noexcept;

  /// Renders into `image`, a new one. Throws GpuError where the GPU fails or lacks memory. The same
  /// request gives the same bytes on one device and driver.
  GpuStats render(const GpuRequest& request, std::shared_ptr<GpuImage>& image);

  const std::shared_ptr<const GpuScene>& scene() const;

 private:
  class Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace foci
