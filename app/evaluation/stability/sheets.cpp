#include "app/evaluation/stability/sheets.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "base/parallel.h"
#include "render/methods/lens_samples.h"
#include "render/scene/builtin/pattern.h"

namespace foci::stability {
namespace {

/// The number of surfels along the sides, and their spacing.
struct Sampling {
  glm::ivec2 count;
  glm::vec2 step_m;
  float side_m;  // side of a square with the area of one surfel
};

Sampling samplingOf(const Sheet& sheet) {
  const float wanted_m = std::abs(sheet.centre_m.z) / kFocal_px;
  const glm::ivec2 count = glm::max(glm::ivec2(sheet.size_m / wanted_m), glm::ivec2(1));
  const glm::vec2 step_m = sheet.size_m / glm::vec2(count);
  return {count, step_m, std::sqrt(step_m.x * step_m.y)};
}

constexpr int kSub = 2;     // points along a side of a pixel
constexpr int kMargin = 5;  // pixels around the image
constexpr int kReach = 9;   // points on either side that the pixel's Gaussian covers: 4.5 sigma

/// A point where a ray meets a sheet.
struct Hit {
  float depth_m;
  const Sheet* sheet;
  glm::vec2 at_m;
};

/// The rays of one frame.
class Rays {
 public:
  Rays(const std::vector<Sheet>& sheets, const View& view, const RenderSettings& settings,
       int samples)
      : view_(view),
        settings_(settings),
        world_from_eye_(glm::inverse(view.eye_from_world)),
        lens_m_(settings.defocus.radius_px_per_D / view.focal_px) {
    for (const Sheet& sheet : sheets) {
      placed_.push_back({&sheet, glm::cross(sheet.across, sheet.up),
                         kSigmaPerSpacing * samplingOf(sheet).side_m});
    }
    for (int i = 0; i < samples; ++i) {
      lens_.push_back(lensSample(i, samples));
      // Box-Muller: the same points in another order, independent of the lens sample.
      const int k = static_cast<int>(static_cast<std::int64_t>(i) * kStride % samples);
      const glm::vec2 disc = lensSample(k, samples);
      const float radius2 = glm::dot(disc, disc);
      normal_.push_back(disc * std::sqrt(-2.0f * std::log(1.0f - radius2) / radius2));
    }
  }

  /// Colour and coverage of a point of the image, the mean over the lens.
  glm::vec4 through(const glm::vec2& point_px, int x, int y) const {
    const glm::vec2 turn = turnOf(hash01(x, y, 1)), other = turnOf(hash01(x, y, 2));
    const glm::vec2 tangent = (point_px - view_.principal_px) / view_.focal_px;
    glm::vec4 sum(0.0f);
    for (std::size_t i = 0; i < lens_.size(); ++i) {
      const glm::vec2 l = turned(lens_[i], turn) * lens_m_;
      const glm::vec3 from(l.x, -l.y, 0.0f);
      const glm::vec3 along =
          glm::vec3(tangent.x, -tangent.y, -1.0f) - settings_.defocus.focus_D * from;
      sum += seen(glm::vec3(world_from_eye_ * glm::vec4(from, 1.0f)),
                  glm::mat3(world_from_eye_) * along, turned(normal_[i], other));
    }
    return sum / static_cast<float>(lens_.size());
  }

 private:
  struct Placed {
    const Sheet* sheet;
    glm::vec3 normal;
    float sigma_m;
  };
  static constexpr int kStride = 61;  // a prime that divides no usual number of samples

  static glm::vec2 turnOf(float turn) {
    const float angle_rad = glm::two_pi<float>() * turn;
    return {std::cos(angle_rad), std::sin(angle_rad)};
  }
  static glm::vec2 turned(const glm::vec2& p, const glm::vec2& by) {
    return {p.x * by.x - p.y * by.y, p.x * by.y + p.y * by.x};
  }

  glm::vec4 seen(const glm::vec3& from, const glm::vec3& along, const glm::vec2& kernel) const {
    constexpr std::size_t kMaxHits = 32;  // more than any scene of the suite has sheets
    std::array<Hit, kMaxHits> hits;
    std::size_t count = 0;
    for (const Placed& one : placed_) {
      const Sheet& sheet = *one.sheet;
      const float depth_m =
          glm::dot(sheet.centre_m - from, one.normal) / glm::dot(along, one.normal);
      if (!(depth_m >= view_.near_m)) continue;
      const glm::vec3 off = from + depth_m * along - sheet.centre_m;
      const glm::vec2 at_m =
          glm::vec2(glm::dot(off, sheet.across), glm::dot(off, sheet.up)) + one.sigma_m * kernel;
      if (!(std::abs(at_m.x) <= 0.5f * sheet.size_m.x &&
            std::abs(at_m.y) <= 0.5f * sheet.size_m.y)) {
        continue;  // the ray passes the sheet, or runs along it
      }
      assert(count < kMaxHits);
      hits[count++] = {depth_m, &sheet, at_m};
    }
    std::sort(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(count),
              [](const Hit& a, const Hit& b) { return a.depth_m < b.depth_m; });
    glm::vec4 light(0.0f);
    float transmittance = 1.0f;
    for (std::size_t i = 0; i < count && transmittance > 0.0f; ++i) {
      const Sheet& sheet = *hits[i].sheet;
      light += transmittance * sheet.opacity * glm::vec4(sheet.color(hits[i].at_m), 1.0f);
      transmittance *= 1.0f - sheet.opacity;
    }
    return light + glm::vec4(transmittance * settings_.lighting.background, 0.0f);
  }

  const View& view_;
  const RenderSettings& settings_;
  glm::mat4 world_from_eye_;
  glm::vec2 lens_m_;
  std::vector<Placed> placed_;
  std::vector<glm::vec2> lens_, normal_;
};

}  // namespace

std::function<glm::vec3(const glm::vec2&)> plain(const glm::vec3& color) {
  return [color](const glm::vec2&) { return color; };
}

std::function<glm::vec3(const glm::vec2&)> textured(const glm::vec3& color, float feature_m) {
  return [=](const glm::vec2& at_m) {
    return color * (0.2f + 0.8f * fractalNoise(at_m / feature_m, 4, 7));
  };
}

void addSurfels(SurfelCloud& cloud, const Sheet& sheet, float misled_deg) {
  const Sampling sampling = samplingOf(sheet);
  const glm::vec3 normal = glm::cross(sheet.across, sheet.up);
  const float off_rad = glm::radians(misled_deg);
  for (int y = 0; y < sampling.count.y; ++y) {
    for (int x = 0; x < sampling.count.x; ++x) {
      const glm::vec2 at_m = (glm::vec2(x, y) + 0.5f) * sampling.step_m - 0.5f * sheet.size_m;
      const float towards_rad = glm::two_pi<float>() * hash01(x, y, 3);
      const glm::vec3 aside =
          std::cos(towards_rad) * sheet.across + std::sin(towards_rad) * sheet.up;
      appendSurfel(cloud, sheet.centre_m + at_m.x * sheet.across + at_m.y * sheet.up,
                   std::cos(off_rad) * normal + std::sin(off_rad) * aside,
                   kSigmaPerSpacing * sampling.side_m, sampling.step_m.x * sampling.step_m.y,
                   sheet.color(at_m), sheet.opacity);
    }
  }
}

Frame exactFrame(const std::vector<Sheet>& sheets, const View& view, const RenderSettings& settings,
                 int samples) {
  assert(settings.defocus.along == DistanceAlong::axis && samples > 0);
  const Rays rays(sheets, view, settings, samples);
  const glm::ivec2 points = (view.size_px + 2 * kMargin) * kSub;
  const auto wide = static_cast<std::size_t>(points.x);
  std::vector<glm::vec4> fine(wide * static_cast<std::size_t>(points.y));
  parallelFor(static_cast<std::size_t>(points.y), [&](std::size_t y) {
    for (std::size_t x = 0; x < wide; ++x) {
      const glm::vec2 point_px = (glm::vec2(x, y) + 0.5f) / float{kSub} - float{kMargin};
      fine[y * wide + x] = rays.through(point_px, static_cast<int>(x), static_cast<int>(y));
    }
  });

  // Apply the pixel's Gaussian, first along rows, then along columns. A pixel's centre lies between
  // two points.
  std::array<float, 2 * kReach> weights;
  float total = 0.0f;
  for (int k = 0; k < 2 * kReach; ++k) {
    const float off_px = (static_cast<float>(k - kReach) + 0.5f) / float{kSub};
    total += weights[static_cast<std::size_t>(k)] = std::exp(-0.5f * off_px * off_px);
  }
  const auto blurred = [&](const std::vector<glm::vec4>& of, int pixel, std::size_t start,
                           int stride) {
    const int first = kSub * (pixel + kMargin) + kSub / 2 - kReach;
    glm::vec4 sum(0.0f);
    for (int k = 0; k < 2 * kReach; ++k) {
      sum += weights[static_cast<std::size_t>(k)] *
             of[start + static_cast<std::size_t>((first + k) * stride)];
    }
    return sum / total;
  };
  std::vector<glm::vec4> rows;
  for (int y = 0; y < points.y; ++y) {
    for (int x = 0; x < view.size_px.x; ++x) {
      rows.push_back(blurred(fine, x, static_cast<std::size_t>(y) * points.x, 1));
    }
  }
  Frame frame{.size_px = view.size_px, .rgba = {}, .depth_m = {}};
  for (int y = 0; y < view.size_px.y; ++y) {
    for (int x = 0; x < view.size_px.x; ++x) {
      frame.rgba.push_back(blurred(rows, y, static_cast<std::size_t>(x), view.size_px.x));
    }
  }
  return frame;
}

}  // namespace foci::stability
