#include <array>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "app/eye/visual_quality.h"

namespace foci {
namespace {

/// A surface of revolution, x^2 + y^2 + (1 + Q) z^2 = 2 R z, z from its vertex into the eye. The
/// refractive indices are those of 543 nm.
struct Surface {
  double vertex_mm, radius_mm, conic, index_outside, index_inside;
};
constexpr std::array<Surface, 4> kSurfaces = {{{0.0, 7.72, -0.26, 1.0, 1.3777},
                                               {0.55, 6.5, 0.0, 1.3777, 1.3391},
                                               {3.6, 10.2, -3.1316, 1.3391, 1.4222},
                                               {7.6, -6.0, -1.0, 1.4222, 1.3377}}};
constexpr Surface kRetina{23.9203, -12.0, 0.0, 1.3377, 1.3377};
constexpr double kStop_mm = 3.6;  // at the lens's vertex
constexpr std::size_t kFirstOfLens = 2;

/// In mm; x to the observer's right, y up, z into the eye.
struct Ray {
  glm::dvec3 at, direction;  // of length 1
};

/// The ray where it meets the surface: at the crossing nearer to the vertex, or ahead.
std::optional<Ray> meet(const Ray& ray, const Surface& surface, bool ahead) {
  const glm::dvec3 p = ray.at - glm::dvec3(0, 0, surface.vertex_mm), d = ray.direction;
  const glm::dvec3 stretch(1.0, 1.0, 1.0 + surface.conic);
  const double c = 1.0 / surface.radius_mm;
  const double two = c * glm::dot(stretch * d, d), one = c * glm::dot(stretch * p, d) - d.z;
  const double none = c * glm::dot(stretch * p, p) - 2.0 * p.z;
  const double root2 = one * one - two * none;
  if (root2 < 0.0) return std::nullopt;
  const double far = -one - std::copysign(std::sqrt(root2), one);
  std::array<double, 2> t{none / far, std::abs(two) < 1e-12 ? none / far : far / two};
  const auto key = [&](double s) {
    return ahead ? (s > 1e-9 ? s : HUGE_VAL) : std::abs(p.z + s * d.z);
  };
  const double s = key(t[0]) <= key(t[1]) ? t[0] : t[1];
  return Ray{ray.at + s * d, d};
}

/// Refracts at the surface, from the index `from` to `to` (Snell's law).
std::optional<Ray> refract(const Ray& ray, const Surface& surface, double from, double to) {
  const std::optional<Ray> met = meet(ray, surface, false);
  if (!met) return std::nullopt;
  const glm::dvec3 p = met->at - glm::dvec3(0, 0, surface.vertex_mm);
  const double c = 1.0 / surface.radius_mm;
  glm::dvec3 normal =
      glm::normalize(glm::dvec3(c * p.x, c * p.y, c * (1.0 + surface.conic) * p.z - 1.0));
  if (glm::dot(normal, ray.direction) > 0.0) normal = -normal;
  const glm::dvec3 out = glm::refract(ray.direction, normal, from / to);
  if (out == glm::dvec3(0.0)) return std::nullopt;
  return Ray{met->at, out};
}

/// From the stop out of the eye through the cornea.
std::optional<Ray> outOfTheEye(std::optional<Ray> ray) {
  for (std::size_t i = kFirstOfLens; ray && i-- > 0;)
    ray = refract(*ray, kSurfaces[i], kSurfaces[i].index_inside, kSurfaces[i].index_outside);
  return ray;
}

/// The ray through the middle of the stop: how it comes from the retina, and how it leaves the eye.
struct ChiefRay {
  Ray from_retina, outside;
};

ChiefRay chiefRay(double field_rad) {
  const glm::dvec3 stop(0, 0, kStop_mm);
  const auto leaving = [&](double inside_rad) {
    return outOfTheEye(Ray{stop, {std::sin(inside_rad), 0.0, -std::cos(inside_rad)}});
  };
  double low = 0.0, high = 0.5 * std::numbers::pi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const std::optional<Ray> ray = leaving(middle);
    const bool wide = !ray || std::atan2(ray->direction.x, -ray->direction.z) > std::abs(field_rad);
    (wide ? high : low) = middle;
  }
  const double inside_rad = std::copysign(low, field_rad);
  std::optional<Ray> back = Ray{stop, {-std::sin(inside_rad), 0.0, std::cos(inside_rad)}};
  for (std::size_t i = kFirstOfLens; back && i < kSurfaces.size(); ++i)
    back = refract(*back, kSurfaces[i], kSurfaces[i].index_outside, kSurfaces[i].index_inside);
  if (back) back = meet(*back, kRetina, true);
  const std::optional<Ray> outside = leaving(inside_rad);
  assert(back && outside);
  return {{back->at, -back->direction}, *outside};
}

/// A ray of the light that leaves the eye from one point of the retina, across the chief ray.
struct Sample {
  glm::dvec2 at_mm;  ///< from the chief ray, to the observer's right and down
  glm::dvec2 slope;  ///< of the wavefront: opposite to the ray's own
  double in_stop_mm;
};

/// The entrance pupil's middle: where the chief ray meets the axis.
glm::dvec3 middleOfPupil_mm(const Ray& outside) {
  return outside.at - outside.at.x / outside.direction.x * outside.direction;
}

/// Rays over a part of the stop that is wider than the pupil.
std::vector<Sample> samplesOf(double field_deg, double pupil_m) {
  constexpr int kAcross = 61;
  constexpr double kNearAxis_rad = 1e-3;
  const double field_rad = field_deg * std::numbers::pi / 180.0;
  const ChiefRay chief = chiefRay(field_rad);
  const glm::dvec3 forward = chief.outside.direction;
  const glm::dvec3 right(-forward.z, 0.0, forward.x), down(0.0, -1.0, 0.0);
  const glm::dvec3 middle_mm = middleOfPupil_mm(
      std::abs(field_rad) > kNearAxis_rad ? chief.outside : chiefRay(kNearAxis_rad).outside);
  const Ray& start = chief.from_retina;
  const glm::dvec3 across = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), start.direction));
  const double reach = 0.85e3 * pupil_m / (start.at.z - kStop_mm);
  std::vector<Sample> samples;
  for (int row = 0; row < kAcross; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const glm::dvec2 to =
          reach * (glm::dvec2(column, row) / (0.5 * (kAcross - 1)) - glm::dvec2(1.0));
      std::optional<Ray> ray = Ray{
          start.at, glm::normalize(start.direction + to.x * across + glm::dvec3(0.0, to.y, 0.0))};
      for (std::size_t i = kSurfaces.size(); ray && i-- > kFirstOfLens;)
        ray = refract(*ray, kSurfaces[i], kSurfaces[i].index_inside, kSurfaces[i].index_outside);
      if (!ray) continue;
      const glm::dvec3 stop_mm =
          ray->at + (kStop_mm - ray->at.z) / ray->direction.z * ray->direction;
      ray = outOfTheEye(ray);
      if (!ray) continue;
      const double along = glm::dot(ray->direction, forward);
      const glm::dvec3 at_mm =
          ray->at + glm::dot(middle_mm - ray->at, forward) / along * ray->direction - middle_mm;
      const glm::dvec3 slope = -ray->direction / along;
      samples.push_back({{glm::dot(at_mm, right), glm::dot(at_mm, down)},
                         {glm::dot(slope, right), glm::dot(slope, down)},
                         glm::length(glm::dvec2(stop_mm))});
    }
  }
  return samples;
}

/// Radius of the stop that appears as a pupil of that diameter on the axis, from rays on the axis.
double stopRadius_mm(const std::vector<Sample>& on_axis, double pupil_m) {
  double ratios = 0.0;
  int count = 0;
  for (const Sample& sample : on_axis) {
    const double share = glm::length(sample.at_mm) / (0.5e3 * pupil_m);
    if (share < 0.9 || share > 1.1) continue;
    ratios += sample.in_stop_mm / glm::length(sample.at_mm);
    ++count;
  }
  return 0.5e3 * pupil_m * ratios / count;
}

/// Wavefront of orders 2 to 4 whose slopes are nearest to the rays'.
Wavefront fit(const std::vector<Sample>& samples, double pupil_m) {
  constexpr int kCoefficients = 15, kTilts = 2, kFirst = 3;
  const double radius_mm = 0.5e3 * pupil_m;
  cv::Mat basis =
      cv::Mat::zeros(2 * static_cast<int>(samples.size()), kCoefficients - kFirst + kTilts, CV_64F);
  cv::Mat slopes(basis.rows, 1, CV_64F), solution;
  std::vector<PupilWavefront> terms;
  for (int j = kFirst; j < kCoefficients; ++j) {
    Wavefront term{.zernike_um = std::vector<double>(static_cast<std::size_t>(j) + 1),
                   .pupil_m = pupil_m};
    term.zernike_um.back() = 1.0;
    terms.emplace_back(term);
  }
  for (int i = 0; i < static_cast<int>(samples.size()); ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    for (int axis = 0; axis < 2; ++axis) {
      const int row = 2 * i + axis;
      slopes.at<double>(row) = sample.slope[axis];
      basis.at<double>(row, axis) = 1.0;
    }
    for (int j = kFirst; j < kCoefficients; ++j) {
      const glm::dvec2 slope =
          terms[static_cast<std::size_t>(j - kFirst)].at(sample.at_mm / radius_mm).slope;
      for (int axis = 0; axis < 2; ++axis)
        basis.at<double>(2 * i + axis, j - kFirst + kTilts) = slope[axis];
    }
  }
  cv::solve(basis, slopes, solution, cv::DECOMP_SVD);
  Wavefront w{.zernike_um = std::vector<double>(kCoefficients), .pupil_m = pupil_m};
  for (int j = kFirst; j < kCoefficients; ++j)
    w.zernike_um[static_cast<std::size_t>(j)] = solution.at<double>(j - kFirst + kTilts);
  return w;
}

}  // namespace

FieldOfEye fieldOfEye(double field_deg, double pupil_m) {
  assert(std::abs(field_deg) <= kMostField_deg && pupil_m > 0.0);
  std::vector<Sample> on_axis = samplesOf(0.0, pupil_m), beside = samplesOf(field_deg, pupil_m);
  const double stop_mm = stopRadius_mm(on_axis, pupil_m);
  const auto isOutside = [&](const Sample& sample) { return sample.in_stop_mm > stop_mm; };
  std::erase_if(on_axis, isOutside);
  std::erase_if(beside, isOutside);
  FieldOfEye field{.added = fit(beside, pupil_m)};
  const Wavefront axis = fit(on_axis, pupil_m);
  for (std::size_t j = 0; j < axis.zernike_um.size(); ++j)
    field.added.zernike_um[j] -= axis.zernike_um[j];
  double wide = 0.0, high = 0.0;
  for (const Sample& sample : beside) {
    wide += sample.at_mm.x * sample.at_mm.x;
    high += sample.at_mm.y * sample.at_mm.y;
  }
  field.pupil_aspect = std::sqrt(wide / high);
  return field;
}

}  // namespace foci
