#include "render/scene/builtin/gallery_stage.h"

namespace foci {

void GalleryStage::add(Shape shape, Paint paint, const Material& material, float opacity,
                       std::function<bool(const SurfacePoint&)> keep) {
  SampledFor audience = audience_;
  audience.step_rad *= material.coarse;
  const ParametricSurface surface{.at = std::move(shape),
                                  .paint = std::move(paint),
                                  .light =
                                      [&](const SurfacePoint& at, const glm::vec3& paint_there) {
                                        return light_.shade(at, paint_there, material);
                                      },
                                  .keep = std::move(keep),
                                  .opacity = opacity,
                                  .two_sided = material.two_sided};
  appendSurface(cloud_, surface, audience);
}

void GalleryStage::addClosed(Shape shape, Paint paint, const Material& material) {
  cloud_.bodies.of_surfel.resize(cloud_.size(), 0);
  add(std::move(shape), std::move(paint), material);
  cloud_.bodies.of_surfel.resize(cloud_.size(), ++bodies_);
}

}  // namespace foci
