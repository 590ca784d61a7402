// The gallery's lamps and the shadows of its exhibits, baked into the surfels. Private to the
// gallery.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/scene/sampling/sample_surface.h"

namespace foci {

/// A sphere that casts an exhibit's shadow.
struct Occluder {
  glm::vec3 center_m;
  float radius_m;
};

struct Material {
  float gloss = 0.0f;      ///< strength of the highlight, 0 to 1
  float hardness = 40.0f;  ///< Blinn-Phong exponent
  bool shadowed = true;
  bool two_sided = false;  ///< lit on the side that faces the eye
  float coarse = 1.0f;     ///< step between surfels over the gallery's usual one
};

class GalleryLight {
 public:
  explicit GalleryLight(const glm::vec3& eye_m) : eye_m_(eye_m) {}

  void addOccluder(const glm::vec3& center_m, float radius_m) {
    occluders_.push_back({center_m, radius_m});
  }

  /// Light that reaches the eye, each channel 0 to 1. Lamps cast the spheres' soft shadows. The
  /// sky, a warm ceiling and a dark floor, is dimmed near occluders (sphere occlusion in closed
  /// form).
  glm::vec3 shade(const SurfacePoint& at, const glm::vec3& paint, const Material& material) const;

 private:
  glm::vec3 eye_m_;
  std::vector<Occluder> occluders_;
};

}  // namespace foci
