// Lights and samples the exhibits of the gallery: shapes go in, surfels come out. Private to the
// gallery.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <utility>

#include "render/scene/builtin/gallery_light.h"
#include "render/scene/builtin/gallery_shapes.h"
#include "render/scene/sampling/sample_surface.h"

namespace foci {

using Paint = std::function<glm::vec3(const SurfacePoint&)>;

class GalleryStage {
 public:
  explicit GalleryStage(const SampledFor& audience) : audience_(audience), light_(audience.eye_m) {}

  /// Shadows exhibits that are added later.
  void addOccluder(const glm::vec3& center_m, float radius_m) {
    light_.addOccluder(center_m, radius_m);
  }

  /// Adds an opaque shape without a hole, which is a closed body.
  void addClosed(Shape shape, Paint paint, const Material& material);

  /// @param keep  whether there is surface at a point; default: everywhere
  void add(Shape shape, Paint paint, const Material& material, float opacity = 1.0f,
           std::function<bool(const SurfacePoint&)> keep = {});

  SurfelCloud take() {
    cloud_.oriented = true;
    cloud_.bodies.of_surfel.resize(cloud_.size(), 0);
    completeBodies(cloud_);
    return std::move(cloud_);
  }

 private:
  SampledFor audience_;
  GalleryLight light_;
  SurfelCloud cloud_;
  std::uint16_t bodies_ = 0;
};

/// Floor, walls and pictures behind the exhibits.
void addRoom(GalleryStage& stage);

/// z of the wall that the eye faces, metres.
inline constexpr float kEndWall_m = -6.0f;

}  // namespace foci
