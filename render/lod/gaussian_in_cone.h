// Where a Gaussian of the scene lies along a cone's ray, and what Gaussians block of the cone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>

#include "render/scene/gaussian_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// The ray is the z axis; offsets from it are tangents of angles.
struct ConeFrame {
  glm::dvec3 origin_m;
  glm::vec3 x, y, z;
  float radius;  ///< tangent of the half angle

  ConeFrame(const glm::dvec3& origin, const glm::dvec3& direction, double half_angle_rad)
      : origin_m(origin), z(direction), radius(static_cast<float>(std::tan(half_angle_rad))) {
    x = tangentTo(z);
    y = glm::cross(z, x);
  }
};

/// A Gaussian that reaches into a cone.
struct GaussianInCone {
  float near_m;      ///< its distance along the ray
  glm::vec2 middle;  ///< its centre
  float xx, xy, yy;  ///< its covariance across the ray, seen from that distance
  float opacity;
};

/// Gaussians end here, in standard deviations.
inline constexpr float kGaussianReach = 3.0f;

/// The distance is the mean, over the cone, of the places where the density is largest along a line
/// parallel to the ray. This is the mean of the normal distribution, given the two lengths across
/// the ray. So a large flat Gaussian lies where the ray meets its plane, however far the centre is.
/// Lines of the narrow cone count as parallel. The renderer's projection at the centre would spread
/// a Gaussian beside the eye, such as the floor below it, over the whole view.
/// @return absent if the Gaussian does not reach into the cone, or lies behind `nearest_m`
inline std::optional<GaussianInCone> gaussianInCone(const ConeFrame& cone,
                                                    const GaussianCloud& cloud, std::size_t i,
                                                    float nearest_m) {
  const glm::vec3 d(glm::dvec3(cloud.position_m[i]) - cone.origin_m);
  const float depth = glm::dot(d, cone.z);
  if (!(depth >= nearest_m)) return std::nullopt;
  // In the cone's axes.
  const glm::mat3 s = matrixOf(cloud.covariance_m2[i]);
  const glm::vec3 sx = s * cone.x, sy = s * cone.y, sz = s * cone.z;
  const float xx = glm::dot(cone.x, sx), xy = glm::dot(cone.x, sy), yy = glm::dot(cone.y, sy);
  const float xz = glm::dot(cone.x, sz), yz = glm::dot(cone.y, sz), zz = glm::dot(cone.z, sz);
  const glm::vec2 aside(glm::dot(d, cone.x), glm::dot(d, cone.y));
  const float window = 0.25f * cone.radius * cone.radius;
  const auto solve = [](float vxx, float vxy, float vyy, const glm::vec2& v) {
    return glm::vec2(vyy * v.x - vxy * v.y, vxx * v.y - vxy * v.x) / (vxx * vyy - vxy * vxy);
  };

  const float window_m2 = window * depth * depth;
  const glm::vec2 solved = solve(xx + window_m2, xy, yy + window_m2, aside);
  const float reach = kGaussianReach * std::sqrt(zz);
  const float near_m = depth - std::clamp(xz * solved.x + yz * solved.y, -reach, reach);
  if (!(near_m >= nearest_m)) return std::nullopt;

  const float inverse = 1.0f / near_m, inverse2 = inverse * inverse;
  const GaussianInCone found{.near_m = near_m,
                             .middle = aside * inverse,
                             .xx = xx * inverse2,
                             .xy = xy * inverse2,
                             .yy = yy * inverse2,
                             .opacity = cloud.opacity[i]};
  const glm::vec2& m = found.middle;
  const float mahalanobis = glm::dot(m, solve(found.xx + window, found.xy, found.yy + window, m));
  return mahalanobis < kGaussianReach * kGaussianReach ? std::optional(found) : std::nullopt;
}

/// The mean opacity over the cone of the Gaussians so far. Rays spread evenly over the cone are
/// composited each by itself, so that Gaussians side by side do not count as one behind another.
///
/// One ray is in the middle, 6 and 12 are on two rings. Each sees through a small window. It has
/// half the variance of its share of the cone. Together the windows have that of the cone's disc.
class ConeOpacity {
 public:
  static constexpr std::size_t kRays = 19;

  explicit ConeOpacity(float radius) : radius_(radius) { through_.fill(1.0f); }

  void add(const GaussianInCone& gaussian) {
    const float window = 0.125f / static_cast<float>(kRays) * radius_ * radius_;
    const float xx = gaussian.xx + window, yy = gaussian.yy + window, xy = gaussian.xy;
    const float det = xx * yy - xy * xy;
    const float sharp = std::max(gaussian.xx * gaussian.yy - xy * xy, 0.0f);
    const float peak = gaussian.opacity * std::sqrt(sharp / det);
    if (!(peak > 0.0f)) return;
    const float qa = -0.5f * yy / det, qb = xy / det, qc = -0.5f * xx / det;
    const std::array<glm::vec2, kRays>& all = rays();
    for (std::size_t k = 0; k < kRays; ++k) {
      const glm::vec2 d = gaussian.middle - radius_ * all[k];
      const float falloff = std::exp((qa * d.x + qb * d.y) * d.x + qc * d.y * d.y);
      // As the renderer does.
      if (gaussian.opacity * falloff >= kMinAlpha) through_[k] *= 1.0f - peak * falloff;
    }
  }

  double mean() const {
    double sum = 0.0;
    for (const float each : through_) sum += static_cast<double>(each);
    return 1.0 - sum / static_cast<double>(kRays);
  }

 private:
  /// On the unit disc.
  static const std::array<glm::vec2, kRays>& rays() {
    static const std::array<glm::vec2, kRays> kAll = [] {
      std::array<glm::vec2, kRays> all{};
      // In the middle of the area of 6 and of 12 shares; then scaled to the variance above.
      constexpr double kVariance = (6.0 * 4.0 + 12.0 * 13.0) / (2.0 * kRays * kRays);
      const double scale = std::sqrt((0.25 - 0.125 / kRays) / kVariance / kRays);
      for (std::size_t k = 1; k < kRays; ++k) {
        const bool inner = k < 7;
        const double turn =
            inner ? static_cast<double>(k) / 6.0 : (static_cast<double>(k) + 0.5) / 12.0;
        const double angle_rad = 2.0 * std::numbers::pi * turn;
        all[k] = glm::vec2(scale * std::sqrt(inner ? 4.0 : 13.0) *
                           glm::dvec2(std::cos(angle_rad), std::sin(angle_rad)));
      }
      return all;
    }();
    return kAll;
  }

  float radius_;
  std::array<float, kRays> through_;
};

}  // namespace foci
