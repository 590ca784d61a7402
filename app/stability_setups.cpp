#include "app/stability_setups.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <random>
#include <utility>

#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/scene/estimate.h"
#include "render/scene/pattern.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace {

constexpr int kSize_px = 128;
using stability::kFocal_px;

/// Blur by depth along the axis: a sheet across it is blurred alike everywhere.
RenderSettings lens(float radius_px_per_D, float focus_D) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D),
                      .focus_D = focus_D,
                      .along = DistanceAlong::axis}};
}

/// Surfels a pixel apart on a rectangle through `centre_m`.
struct Sheet {
  glm::vec3 centre_m{0.0f};
  glm::vec2 size_m{1.0f};
  glm::vec3 across{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};  ///< unit
  std::function<glm::vec3(const glm::vec2&)> color;          ///< by place on the sheet, m
  float opacity = 1.0f;
};

void add(SurfelCloud& cloud, const Sheet& sheet) {
  const float wanted_m = std::abs(sheet.centre_m.z) / kFocal_px;
  const glm::ivec2 count = glm::max(glm::ivec2(sheet.size_m / wanted_m), glm::ivec2(1));
  const glm::vec2 step_m = sheet.size_m / glm::vec2(count);
  const float side_m = std::sqrt(step_m.x * step_m.y);
  for (int y = 0; y < count.y; ++y) {
    for (int x = 0; x < count.x; ++x) {
      const glm::vec2 at_m = (glm::vec2(x, y) + 0.5f) * step_m - 0.5f * sheet.size_m;
      appendSurfel(cloud, sheet.centre_m + at_m.x * sheet.across + at_m.y * sheet.up,
                   glm::cross(sheet.across, sheet.up), kSigmaPerSpacing * side_m,
                   step_m.x * step_m.y, sheet.color(at_m), sheet.opacity);
    }
  }
}

std::function<glm::vec3(const glm::vec2&)> plain(const glm::vec3& color) {
  return [color](const glm::vec2&) { return color; };
}

/// Large and small features, the same at any sampling.
std::function<glm::vec3(const glm::vec2&)> textured(const glm::vec3& color, float feature_m) {
  return [=](const glm::vec2& at_m) {
    return color * (0.2f + 0.8f * fractalNoise(at_m / feature_m, 4, 7));
  };
}

const glm::vec3 kRed{1.0f, 0.0f, 0.0f}, kGreen{0.0f, 1.0f, 0.0f};

/// A red half-plane left of the axis before a green sheet.
SurfelCloud edgeScene(float near_m, float far_m) {
  SurfelCloud cloud;
  const float half_m = 0.5f * kSize_px / kFocal_px;  // of the view, a metre away
  add(cloud, {.centre_m = {0, 0, -far_m},
              .size_m = glm::vec2(4.0f * half_m * far_m),
              .color = plain(kGreen)});
  add(cloud, {.centre_m = {-1.5f * half_m * near_m, 0, -near_m},
              .size_m = {3.0f * half_m * near_m, 5.0f * half_m * near_m},
              .color = plain(kRed)});
  return cloud;
}

/// Mean difference of red and closed form, over the pixels within `reach_px` of the edge in the
/// middle rows.
double edgeError(const Frame& frame, double radius_px, double reach_px) {
  const double sigma_px = std::sqrt(1.0 + kSigmaPerSpacing * kSigmaPerSpacing);
  double sum = 0.0, count = 0.0;
  for (int y = kSize_px / 4; y < 3 * kSize_px / 4; ++y) {
    for (int x = 0; x < kSize_px; ++x) {
      const double off_px = 0.5 * kSize_px - (x + 0.5);
      if (std::abs(off_px) > reach_px) continue;
      const double share = edgeShare(off_px, radius_px, sigma_px);
      const glm::vec4& at = frame.at(x, y);
      sum += std::isfinite(at.r) ? std::abs(at.r - share) : 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

/// Mean lack or excess of coverage away from the border.
double coverageError(const Frame& frame, float alpha, int border_px) {
  double sum = 0.0, count = 0.0;
  for (int y = border_px; y < kSize_px - border_px; ++y) {
    for (int x = border_px; x < kSize_px - border_px; ++x) {
      const float a = frame.at(x, y).a;
      sum += std::isfinite(a) ? std::abs(a - alpha) : 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

}  // namespace

namespace stability {

View view() {
  return {.size_px = glm::ivec2(kSize_px),
          .focal_px = glm::vec2(kFocal_px),
          .principal_px = glm::vec2(0.5f * kSize_px)};
}

StabilitySetup parallel(float gap_m) {
  constexpr float kNear_m = 0.5f, kBlur_px = 10.0f;
  return {.cloud = edgeScene(kNear_m, kNear_m + gap_m),
          .settings = lens(kBlur_px, 1.0f / kNear_m - 1.0f),
          .score = [=](const Frame& frame) { return edgeError(frame, kBlur_px, 48.0); }};
}

/// @param deep_m  how far the slanted plane reaches before and behind where they meet, at most
static StabilitySetup crossing(float angle_deg, float deep_m) {
  SurfelCloud cloud;
  const float a = glm::radians(angle_deg);
  add(cloud, {.centre_m = {0, 0, -1},
              .size_m = glm::vec2(1.2f),
              .color = textured({1, 0.6f, 0.2f}, 0.06f)});
  add(cloud, {.centre_m = {0, 0, -1},
              .size_m = {std::min(1.2f, 2.0f * deep_m / std::sin(a)), 1.2f},
              .across = {std::cos(a), 0, std::sin(a)},
              .color = textured({0.2f, 0.5f, 1}, 0.06f)});
  return {.cloud = std::move(cloud), .settings = lens(18.0f, 0.5f)};
}

StabilitySetup intersecting(float angle_deg) { return crossing(angle_deg, 0.15f); }
StabilitySetup intersectingDeep(float angle_deg) { return crossing(angle_deg, 0.6f); }

StabilitySetup density(float ratio) {
  // Points per area fall by `ratio` from the left to the right of the picture.
  constexpr float kSide_m = 0.6f, kFinest_m = 1.0f / kFocal_px;
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) / float{1 << 24}; };
  PointCloud points;
  for (float x = -0.5f * kSide_m; x < 0.5f * kSide_m;) {
    const float along = std::clamp(x / (kSize_px * kFinest_m) + 0.5f, 0.0f, 1.0f);
    const float step_m = kFinest_m * std::pow(ratio, 0.5f * along);
    for (float y = -0.5f * kSide_m; y < 0.5f * kSide_m; y += step_m) {
      const glm::vec2 jitter = 0.5f * step_m * glm::vec2(uniform() - 0.5f, uniform() - 0.5f);
      points.position_m.emplace_back(x + jitter.x, y + jitter.y, -1.0f);
      points.color.emplace_back(1.0f);
    }
    x += step_m;
  }
  SurfelCloud cloud = surfelsFromPoints(std::move(points), {.viewpoint_m = glm::vec3(0.0f)});
  return {.cloud = std::move(cloud), .settings = lens(6.0f, 0.0f), .score = [](const Frame& frame) {
            return coverageError(frame, 1.0f, 8);
          }};
}

StabilitySetup wire(float width_px) {
  SurfelCloud cloud;
  const float width_m = width_px / kFocal_px;
  add(cloud, {.centre_m = {0, 0, -2}, .size_m = glm::vec2(2.0f), .color = plain(kGreen)});
  // As many surfels along as fit its width, at least a pixel apart.
  add(cloud, {.centre_m = {0, 0, -1}, .size_m = {width_m, 1.0f}, .color = plain(kRed)});
  return {
      .cloud = std::move(cloud), .settings = lens(12.0f, 0.5f), .score = [=](const Frame& frame) {
        double red = 0.0;
        for (int y = kSize_px / 4; y < 3 * kSize_px / 4; ++y) {
          for (int x = 0; x < kSize_px; ++x) red += frame.at(x, y).r;
        }
        return std::abs(red / (0.5 * kSize_px) / width_px - 1.0);
      }};
}

StabilitySetup sharpSilhouette(float radius_px) {
  return {.cloud = edgeScene(1.0f, 2.0f),
          .settings = lens(2.0f * radius_px, 1.0f),
          .score = [=](const Frame& frame) { return edgeError(frame, 0.0, radius_px + 4.0); }};
}

StabilitySetup blurredSilhouette(float radius_px) {
  return {
      .cloud = edgeScene(1.0f, 2.0f),
      .settings = lens(2.0f * radius_px, 0.5f),
      .score = [=](const Frame& frame) { return edgeError(frame, radius_px, radius_px + 4.0); }};
}

StabilitySetup closeUp(float distance_m) {
  constexpr float kPupil_px_per_D = 2.0f;
  return {.cloud = edgeScene(distance_m, 1.0f),
          .settings = lens(kPupil_px_per_D, 1.0f),
          .score = [=](const Frame& frame) {
            return edgeError(frame, kPupil_px_per_D * (1.0f / distance_m - 1.0f), 0.5 * kSize_px);
          }};
}

StabilitySetup focusRange(float focus_D) {
  SurfelCloud cloud;
  const float half_m = 0.5f * kSize_px / kFocal_px;
  for (const auto& [depth_m, middle] : {std::pair(1000.0f, 0.0f), {1.0f, -0.7f}, {0.1f, 1.2f}}) {
    const float wide_m = middle == 0.0f ? 4.0f : 1.0f;
    add(cloud, {.centre_m = {middle * half_m * depth_m, 0, -depth_m},
                .size_m = glm::vec2(wide_m, 4.0f) * half_m * depth_m,
                .color = textured(glm::vec3(1.0f, 0.5f + 0.3f * middle, 0.7f), 0.1f * depth_m)});
  }
  return {.cloud = std::move(cloud), .settings = lens(2.0f, focus_D)};
}

StabilitySetup transparent(float layers) {
  constexpr float kOpacity = 0.3f;
  SurfelCloud cloud;
  for (int k = 0; k < static_cast<int>(layers); ++k) {
    const float depth_m = 1.0f + 0.1f * static_cast<float>(k);
    add(cloud, {.centre_m = {0, 0, -depth_m},
                .size_m = glm::vec2(0.9f * depth_m),
                .color = plain(kRed),
                .opacity = kOpacity});
  }
  return {
      .cloud = std::move(cloud), .settings = lens(8.0f, 0.0f), .score = [=](const Frame& frame) {
        return coverageError(frame, 1.0f - std::pow(1.0f - kOpacity, layers), 24);
      }};
}

StabilitySetup highlightOf(float times) {
  SurfelCloud cloud;
  add(cloud, {.centre_m = {0, 0, -1}, .size_m = glm::vec2(0.6f), .color = plain(glm::vec3(0.1f))});
  cloud.color[cloud.size() / 2 + 90].r += 0.1f * times;
  return {.cloud = std::move(cloud), .settings = lens(10.0f, 0.0f)};
}

StabilitySetup slanted(float angle_deg) {
  const float a = glm::radians(angle_deg);
  SurfelCloud cloud;
  add(cloud, {.centre_m = {0, 0, -1},
              .size_m = glm::vec2(0.5f, 0.6f) * glm::vec2(1.0f / std::max(std::cos(a), 0.2f), 1.0f),
              .across = {std::cos(a), 0, std::sin(a)},
              .color = textured(glm::vec3(1.0f), 0.05f)});
  return {.cloud = std::move(cloud), .settings = lens(40.0f, 1.0f)};
}

StabilitySetup sweptScene(float radius_px_per_D) {
  SurfelCloud cloud;
  add(cloud, {.centre_m = {0, 0, -2},
              .size_m = glm::vec2(1.4f),
              .color = textured(glm::vec3(1.0f), 0.1f)});
  add(cloud, {.centre_m = {-0.12f, 0, -1},
              .size_m = {0.24f, 0.6f},
              .color = textured({1, 0.4f, 0.1f}, 0.05f)});
  return {.cloud = std::move(cloud), .settings = lens(radius_px_per_D, 0.6f)};
}

}  // namespace stability

double edgeShare(double distance_px, double radius_px, double sigma_px) {
  const auto disc = [&](double x) {
    if (radius_px <= 0.0) return x > 0.0 ? 1.0 : x < 0.0 ? 0.0 : 0.5;
    const double t = std::clamp(x / radius_px, -1.0, 1.0);
    return (std::acos(-t) + t * std::sqrt(1.0 - t * t)) / glm::pi<double>();
  };
  if (radius_px <= 0.0) return 0.5 * std::erfc(-distance_px / (sigma_px * std::sqrt(2.0)));
  constexpr int kSteps = 48;
  double sum = 0.0, total = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double z = 4.0 * i / kSteps;
    const double w = std::exp(-0.5 * z * z);
    sum += w * disc(distance_px - z * sigma_px);
    total += w;
  }
  return sum / total;
}

}  // namespace foci
