#include "tests/faces/relief.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"

namespace foci::faces {
namespace {

constexpr double kStep_mm = 0.5;
constexpr double kHalfWidth_mm = 95.0, kTop_mm = -140.0, kBottom_mm = 135.0;
constexpr float kBeside = -1000.0f;
constexpr double kFrontmost_mm = 62.0, kBackmost_mm = -75.0;
constexpr double kAround_mm = 14.0;  // half of the region whose maximum height is `ceiling_`

double bump(double x, double width) { return std::exp(-(x / width) * (x / width)); }

double step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

float height(const Person& p, double x, double y) {
  const double half_width = 0.53 * p.face_width_mm * (1.0 - 0.24 * step(15.0, 115.0, y));
  const double tall = y < 0.0 ? 128.0 : 118.0;
  const double inside =
      1.0 - std::pow(std::abs(x) / half_width, 2.2) - std::pow(std::abs(y) / tall, 2.6);
  if (inside <= 0.0) return kBeside;
  const double ax = std::abs(x), eye = 0.5 * p.ipd_mm;
  double h = -75.0 + 95.0 * std::sqrt(inside);
  h += 5.0 * bump(y + 17.0, 8.0) * bump(x, 48.0);                       // brow ridge
  h -= 8.0 * bump(ax - eye, 17.0) * bump(y, 13.0);                      // sockets
  h += p.nose_mm * step(-8.0, 42.0, y) * (1.0 - step(44.0, 56.0, y)) *  // nose
       bump(x, 6.5 + 7.0 * step(10.0, 45.0, y));
  h += 4.0 * bump(ax - 42.0, 18.0) * bump(y - 34.0, 18.0);  // cheeks
  h += bump(x, 22.0) * (5.0 * bump(y - 69.0, 5.0) + 5.5 * bump(y - 79.0, 6.0));
  h -= 3.0 * bump(x, 18.0) * bump(y - 90.0, 5.0);
  h += 9.0 * bump(x, 22.0) * bump(y - 104.0, 12.0);  // chin
  const double shell2 = kLids_mm * kLids_mm - (ax - eye) * (ax - eye) - y * y;
  if (shell2 > 0.0) {
    const double shell = std::sqrt(shell2);
    constexpr double kSoft_mm = 1.0;  // a smooth maximum
    h = 0.5 * (h + shell + std::sqrt((h - shell) * (h - shell) + kSoft_mm * kSoft_mm));
  }
  return static_cast<float>(h);
}

glm::vec3 albedo(const Person& p, double x, double y) {
  const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
  const auto grain = [&](float scale, std::uint32_t which) {
    return smoothNoise(fx / scale + 500.0f, fy / scale + 500.0f, p.seed * 16 + which) - 0.5f;
  };
  const double ax = std::abs(x), eye = 0.5 * p.ipd_mm;
  glm::vec3 colour =
      p.skin * (1.0f + 0.18f * grain(14.0f, 0) + 0.14f * grain(4.0f, 1) + 0.12f * grain(1.3f, 2));
  const float freckle = smoothNoise(fx / 3.0f + 900.0f, fy / 3.0f + 900.0f, p.seed * 16 + 3);
  if (freckle > 0.86f) colour *= 1.0f - 1.6f * (freckle - 0.86f);
  const auto blend = [&](const glm::vec3& to, double share) {
    colour = glm::mix(colour, to, static_cast<float>(std::clamp(share, 0.0, 1.0)));
  };
  blend(colour * glm::vec3(1.1f, 0.85f, 0.85f), bump(ax - 42.0, 18.0) * bump(y - 32.0, 15.0));
  // Dark rings under the eyes and above the lids.
  blend(colour * 0.72f, 0.7 * bump(ax - eye, 14.0) * (bump(y - 12.0, 5.0) + bump(y + 9.0, 3.5)));
  const glm::vec3 lips = p.skin * glm::vec3(0.85f, 0.48f, 0.48f);
  const double cupid = 1.2 * bump(ax - 5.0, 4.0) - 1.0 * bump(x, 3.0);
  const double lip = step(25.0, 22.0, ax) * step(66.0 - cupid, 68.5 - cupid, y + 0.008 * x * x) *
                     step(84.0, 81.0, y + 0.012 * x * x);
  blend(lips, lip);
  blend(p.skin * 0.12f, 0.9 * bump(y - 74.5 + 0.003 * x * x, 1.1) * step(26.0, 22.0, ax));
  blend(p.skin * 0.12f, 0.95 * step(1.3, 0.7, std::hypot((ax - 7.5) / 4.0, (y - 52.5) / 2.3)));
  if (p.beard) {
    const double jaw = step(48.0, 62.0, y + 0.004 * x * x) * (1.0 - lip);
    blend(p.hair, jaw * (0.55 + 1.2 * grain(0.9f, 4)));
  }
  // Brows consist of strokes, hair of strands.
  const double along = (ax - eye + 2.0) / 23.0;
  const double brow_y = -20.0 - 3.5 * (1.0 - along * along) + 1.5 * along;
  const double thick = std::max(0.1, 4.4 * (1.0 - 0.5 * std::max(0.0, along)));
  const double brow =
      step(1.1, 0.6, std::abs(along)) * step(thick, 0.4 * thick, std::abs(y - brow_y));
  const float stroke =
      smoothNoise(fx / 0.8f + 0.5f * fy + 700.0f, fy / 3.0f + 700.0f, p.seed * 16 + 5);
  blend(p.hair, brow * (0.7 + 0.6 * static_cast<double>(stroke)));
  const double hairline = -72.0 + 0.006 * x * x + 8.0 * grain(9.0f, 6);
  const double sides =
      step(0.44 * p.face_width_mm, 0.47 * p.face_width_mm, ax) * step(22.0, 5.0, y);
  const float strand = smoothNoise(fx / 1.1f + 300.0f, fy / 14.0f + 300.0f, p.seed * 16 + 7);
  blend(p.hair * (0.6f + 0.9f * strand), std::max(step(hairline + 3.0, hairline - 3.0, y), sides));
  return colour;
}

template <class Pixels>
auto bilinear(const Pixels& grid, double x, double y) {
  const double gx = (x + kHalfWidth_mm) / kStep_mm, gy = (y - kTop_mm) / kStep_mm;
  const int ix = std::clamp(static_cast<int>(gx), 0, grid.cols - 2);
  const int iy = std::clamp(static_cast<int>(gy), 0, grid.rows - 2);
  const auto u = static_cast<float>(std::clamp(gx - ix, 0.0, 1.0));
  const auto v = static_cast<float>(std::clamp(gy - iy, 0.0, 1.0));
  return (grid(iy, ix) * (1.0f - u) + grid(iy, ix + 1) * u) * (1.0f - v) +
         (grid(iy + 1, ix) * (1.0f - u) + grid(iy + 1, ix + 1) * u) * v;
}

}  // namespace

Relief::Relief(const Person& person) {
  const int width = static_cast<int>(2.0 * kHalfWidth_mm / kStep_mm) + 1;
  const int rows = static_cast<int>((kBottom_mm - kTop_mm) / kStep_mm) + 1;
  height_.create(rows, width);
  albedo_.create(rows, width);
  normal_.create(rows, width);
  parallelFor(static_cast<std::size_t>(rows), [&](std::size_t i) {
    const int row = static_cast<int>(i);
    for (int column = 0; column < width; ++column) {
      const double x = column * kStep_mm - kHalfWidth_mm, y = row * kStep_mm + kTop_mm;
      height_(row, column) = height(person, x, y);
      const glm::vec3 colour = albedo(person, x, y);
      albedo_(row, column) = {colour.r, colour.g, colour.b};
      const double e = 0.4;
      const auto slope = [&](double dx, double dy) {
        const float s = (height(person, x + dx, y + dy) - height(person, x - dx, y - dy)) /
                        static_cast<float>(2.0 * e);
        return std::clamp(s, -6.0f, 6.0f);
      };
      const glm::vec3 n = glm::normalize(glm::vec3(-slope(e, 0.0), -slope(0.0, e), -1.0f));
      normal_(row, column) = {n.x, n.y, n.z};
    }
  });
  const int around_side = 2 * static_cast<int>(kAround_mm / kStep_mm) + 1;
  cv::dilate(height_, ceiling_, cv::Mat(around_side, around_side, CV_8U, cv::Scalar(1)));
  // A point deeper than its surroundings gets less ambient light.
  cv::Mat1f around;
  cv::GaussianBlur(cv::max(height_, -60.0f), around, {}, 9.0 / kStep_mm);
  open_ = 1.0f - 0.07f * (around - cv::max(height_, -60.0f));
  cv::max(open_, 0.35f, open_);
  cv::min(open_, 1.15f, open_);
}

std::optional<float> Relief::heightAt(double x, double y) const {
  if (std::abs(x) >= kHalfWidth_mm || y <= kTop_mm || y >= kBottom_mm) return std::nullopt;
  const float h = bilinear(height_, x, y);
  return h > 2.0f * static_cast<float>(kBackmost_mm) ? std::optional(h) : std::nullopt;
}

std::optional<glm::dvec3> Relief::meet(const glm::dvec3& origin, const glm::dvec3& d) const {
  // A step may be as long as the distance to the ceiling, within these limits.
  constexpr double kMarch_mm = 2.5, kLeap_mm = 20.0;
  if (!(d.z > 0.0)) return std::nullopt;
  const glm::dvec2 slope = glm::dvec2(d) / d.z, start = glm::dvec2(origin) - slope * origin.z;
  const auto pointAt = [&](double z) { return glm::dvec3(start + slope * z, z); };
  const auto isInside = [&](const glm::dvec3& p) {
    const auto h = heightAt(p.x, p.y);
    return h && -p.z <= static_cast<double>(*h);
  };
  // The part of the ray above the grid.
  double from = -kFrontmost_mm, to = -kBackmost_mm;
  const std::array<glm::dvec2, 2> sides{glm::dvec2(-kHalfWidth_mm, kHalfWidth_mm),
                                        glm::dvec2(kTop_mm, kBottom_mm)};
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({(sides[axis][0] - start[axis]) / slope[axis],
                                          (sides[axis][1] - start[axis]) / slope[axis]});
    from = std::max(from, low);
    to = std::min(to, high);
  }
  double before = from;
  for (double z = from; z <= to;) {
    const glm::dvec3 p = pointAt(z);
    const int column = static_cast<int>((p.x + kHalfWidth_mm) / kStep_mm);
    const int row = static_cast<int>((p.y - kTop_mm) / kStep_mm);
    const bool is_over = column >= 0 && column < ceiling_.cols && row >= 0 && row < ceiling_.rows;
    const double ceiling = is_over ? ceiling_(row, column) : kBeside;
    if (-z <= ceiling && isInside(p)) {
      double low = before, high = z;
      for (int i = 0; i < 8; ++i) {
        const double middle = 0.5 * (low + high);
        (isInside(pointAt(middle)) ? high : low) = middle;
      }
      return pointAt(high);
    }
    before = z;
    z += std::clamp(-z - ceiling, kMarch_mm, kLeap_mm);
  }
  return std::nullopt;
}

glm::vec3 Relief::colourAt(double x, double y, const glm::vec3& towards_light,
                           float ambient) const {
  const cv::Vec3f a = bilinear(albedo_, x, y), n = bilinear(normal_, x, y);
  const float open = bilinear(open_, x, y);
  const glm::vec3 normal = glm::normalize(glm::vec3(n[0], n[1], n[2]));
  // Skin scatters light a little beyond the terminator.
  const float lit = std::max(0.0f, (glm::dot(normal, towards_light) + 0.25f) / 1.25f);
  return glm::vec3(a[0], a[1], a[2]) * open * (ambient + (1.0f - ambient) * lit);
}

}  // namespace foci::faces
