// Lights and samples the exhibits of the gallery: parametric surfaces go in, surfels come out.
// Lamps and shadows are baked into the surfels. Private to the gallery.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <utility>
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

/// A surface over the unit square. Normals along cross(du, dv) point outwards.
using Shape = std::function<glm::vec3(glm::vec2)>;
using Curve = std::function<glm::vec3(float)>;

/// corner + u edge_u + v edge_v.
Shape rectangle(const glm::vec3& corner, const glm::vec3& edge_u, const glm::vec3& edge_v);

Shape ball(const glm::vec3& center, float radius);

/// A profile of (radius, height) points, smoothly joined (Catmull-Rom), turned about a vertical
/// axis. `flutes` grooves of relative depth `flute_depth` run along it.
Shape lathe(const glm::vec3& foot, std::vector<glm::vec2> profile, int flutes = 0,
            float flute_depth = 0.0f);

/// A tube around a curve over 0 to 1, u around it, v along. `aside` is never along the curve.
Shape tube(const Curve& curve, const std::function<float(float)>& radius, const glm::vec3& aside);

/// A leaf of a plant: from `base` along `rise`, bent by `droop`, `width` at its widest.
Shape leaf(const glm::vec3& base, const glm::vec3& rise, const glm::vec3& side, float droop);

/// A head about `center`, life-sized at scale 1, that faces +z; azimuth and elevation (rad) span
/// the unit square. `hair` roughens skull and neck.
Shape head(const glm::vec3& center, float scale, glm::vec2 azimuth, glm::vec2 elevation, bool hair);

/// The torus knot that winds p times about its axis (z) and q times about its core.
Curve torusKnot(const glm::vec3& center, float scale, int p, int q);

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
