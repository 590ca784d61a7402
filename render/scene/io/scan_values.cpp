#include "render/scene/io/scan_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/image/srgb.h"

namespace foci {

glm::vec3 linearColor(const glm::vec3& srgb) {
  return {linearFromSrgb(srgb.x), linearFromSrgb(srgb.y), linearFromSrgb(srgb.z)};
}

glm::vec3 unitNormal(const glm::dvec3& normal) {
  const double length = glm::length(normal);
  const bool usable = length > 1e-12 && length < 1e150;  // false for NaN
  return usable ? glm::vec3(normal / length) : glm::vec3(0.0f);
}

bool isNearEnough(const glm::dvec3& p) {
  return glm::all(glm::lessThanEqual(glm::abs(p), glm::dvec3(kFarthest_m)));  // false for NaN
}

glm::dvec3 originNear(const glm::dvec3& p) {
  constexpr double kFar = 1e4, kStep = 1e3;
  const auto near = [](double x) {
    return std::abs(x) < kFar ? 0.0 : kStep * std::round(x / kStep);
  };
  return {near(p.x), near(p.y), near(p.z)};
}

void remarkOrigin(const glm::dvec3& origin, std::vector<std::string>& remarks) {
  if (origin == glm::dvec3(0.0)) return;
  remarks.push_back("positions are relative to " + decimal(origin.x, 0) + " " +
                    decimal(origin.y, 0) + " " + decimal(origin.z, 0) +
                    " of the file, to keep their millimetres");
}

bool ScanPositions::append(const glm::dvec3& p) {
  if (!origin_ && isNearEnough(p)) origin_ = originNear(p);
  return appendInPlace(p);
}

bool ScanPositions::appendInPlace(const glm::dvec3& p) {
  if (!isNearEnough(p)) {
    ++points_.dropped;
    return false;
  }
  points_.position_m.emplace_back(p - origin_.value_or(glm::dvec3(0.0)));
  return true;
}

void ScanPositions::finish(const std::string& file) const {
  if (points_.size() == 0) {
    throw InputError(
        file, points_.dropped == 0 ? "has no points" : "none of its points has a finite position");
  }
  if (origin_) remarkOrigin(*origin_, points_.remarks);
}

bool losesDetail(std::span<const glm::vec3> position) {
  constexpr float kStepsShown = 1 << 13;  // across the scene; a screen has fewer columns
  const auto [low, high] = boxOf(position);
  const glm::vec3 far = glm::max(glm::abs(low), glm::abs(high)), size = high - low;
  const float step = std::max({far.x, far.y, far.z}) * std::numeric_limits<float>::epsilon();
  return step * kStepsShown > std::max({size.x, size.y, size.z});
}

void remarkDegrees(PointCloud& points) {
  constexpr float kHalfTurn = 180.0f, kSlender = 1000.0f;
  constexpr std::size_t kEnough = 8;
  if (points.size() < kEnough) return;
  const auto [low, high] = boxOf(points.position_m);
  const glm::vec3 size = high - low, far = glm::max(glm::abs(low), glm::abs(high));
  if (!(std::min(size.x, size.y) > 0.0f && std::max(far.x, far.y) <= kHalfTurn)) return;
  if (!(size.z > kSlender * std::max(size.x, size.y))) return;
  points.remarks.emplace_back(
      "x and y may be longitude and latitude in degrees, which foci takes for the unit of z: "
      "project them to metres, e.g. with QGIS or pdal's filters.reprojection");
}

void dropPlainOpacity(PointCloud& points) {
  if (points.opacity.empty()) return;
  const auto [least, most] = std::ranges::minmax(points.opacity);
  const bool hidden = most <= kNoOpacity;
  if (hidden)
    points.remarks.emplace_back("the alpha of all points is 0, or 1 of 255: shown opaque");
  if (hidden || least == 1.0f) points.opacity.clear();
}

void remarkDark(PointCloud& points) {
  constexpr float kDark = 0.125f;  // of the range, in sRGB code values; chosen by hand
  float brightest = 0.0f;
  for (const glm::vec3& c : points.color) brightest = std::max({brightest, c.x, c.y, c.z});
  if (brightest <= 0.0f || brightest >= linearFromSrgb(kDark)) return;
  points.remarks.emplace_back(
      "its colours use less than an eighth of their range, so the scene is nearly black: if the "
      "range is another, scale them");
}

std::vector<glm::vec3> greyOf(const std::vector<float>& intensity) {
  std::vector<glm::vec3> grey(intensity.size(), glm::vec3(kUncolouredLight));
  if (intensity.empty()) return grey;
  std::vector<float> ranked = intensity;
  const float low = quantile(ranked, 0.01), high = quantile(ranked, 0.99);
  if (!(high > low)) return grey;
  for (std::size_t i = 0; i < intensity.size(); ++i) {
    const float code = std::clamp((intensity[i] - low) / (high - low), 0.0f, 1.0f);
    grey[i] = glm::vec3(linearFromSrgb(code));
  }
  return grey;
}

}  // namespace foci
