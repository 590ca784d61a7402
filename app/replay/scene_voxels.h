// A scene as cubes that are full or empty: a rough answer to where a ray meets it, in little time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "render/scene/scene.h"

namespace foci {

/// Radius of a disc about a surfel or Gaussian, so that discs cover the surface.
float coveringRadius_m(const SurfelCloud& cloud, std::size_t i);
float coveringRadius_m(const GaussianCloud& cloud, std::size_t i);

class SceneVoxels {
 public:
  /// The cubes are a share of the box's longest side, and at least as wide as discs.
  /// @param low_m, high_m  what lies outside is left out
  SceneVoxels(const Scene& scene, const glm::dvec3& low_m, const glm::dvec3& high_m);

  /// Walks from cube to cube (Amanatides and Woo, 1987).
  /// @param direction  unit
  /// @return to the middle of the first full cube's stretch of the ray; 0 if the origin is in one
  std::optional<double> distance_m(const glm::dvec3& origin_m, const glm::dvec3& direction) const;

  double cube_m() const { return cube_m_; }

 private:
  void fill(const auto& cloud, const glm::dvec3& high_m);
  std::size_t indexOf(const glm::ivec3& at) const {
    return (std::size_t(at.z) * std::size_t(count_.y) + std::size_t(at.y)) * std::size_t(count_.x) +
           std::size_t(at.x);
  }

  glm::dvec3 low_m_;
  double cube_m_ = 0.0;
  glm::ivec3 count_{0};
  std::vector<std::uint8_t> full_{};
};

}  // namespace foci
