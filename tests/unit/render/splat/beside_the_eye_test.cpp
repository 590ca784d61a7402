// Surfels below and beside the eye, almost in the plane through the eye across its axis, against
// the rays of a pinhole through a plane.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kSpacing_m = 0.02f, kHalfSide_m = 1.5f, kFocal_px = 96.0f;
constexpr int kSize_px = 96, kHorizon_px = kSize_px / 2;
const glm::vec3 kSky(0.2f, 0.4f, 0.8f);

/// Waves of 0.8 m, much longer than a surfel.
glm::vec3 colourAt(float x_m, float z_m) {
  return {0.5f + 0.3f * std::sin(8.0f * x_m), 0.5f + 0.3f * std::cos(8.0f * z_m), 0.1f};
}

/// The ground about the eye, which is `height_m` above it at the origin.
SurfelCloud ground(float height_m) {
  SurfelCloud cloud;
  const int side = static_cast<int>(std::lround(2.0f * kHalfSide_m / kSpacing_m));
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const float x_m = (static_cast<float>(i) + 0.5f) * kSpacing_m - kHalfSide_m;
      const float z_m = (static_cast<float>(j) + 0.5f) * kSpacing_m - kHalfSide_m;
      appendSurfel(cloud, {x_m, -height_m, z_m}, {0.0f, 1.0f, 0.0f}, kSigmaPerSpacing * kSpacing_m,
                   kSpacing_m * kSpacing_m, colourAt(x_m, z_m));
    }
  }
  return cloud;
}

/// The colour of the ground along the ray of a pixel; nothing beyond its edge.
std::optional<glm::vec3> rayThrough(float x_px, float y_px, float height_m) {
  const float down = (y_px - kHorizon_px) / kFocal_px, right = (x_px - kSize_px / 2) / kFocal_px;
  if (down <= 0.0f) return std::nullopt;
  const float depth_m = height_m / down;
  if (depth_m > kHalfSide_m || std::abs(right * depth_m) > kHalfSide_m) return std::nullopt;
  return colourAt(right * depth_m, -depth_m);
}

/// The largest difference from the rays, outside a band about the horizon, where the ground ends.
float largestDifference(const Frame& frame, float height_m) {
  const int edge_px = kHorizon_px + static_cast<int>(kFocal_px * height_m / kHalfSide_m);
  constexpr int kSoft_px = 6;  // the last surfels and the prefilter
  float largest = 0.0f;
  for (int y = 0; y < kSize_px; ++y) {
    if (y >= kHorizon_px - kSoft_px && y <= edge_px + kSoft_px) continue;
    for (int x = 0; x < kSize_px; ++x) {
      const glm::vec3 ray =
          rayThrough(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, height_m)
              .value_or(kSky);
      const glm::vec3 apart = glm::abs(glm::vec3(frame.at(x, y)) - ray);
      largest = std::max({largest, apart.r, apart.g, apart.b});
    }
  }
  return largest;
}

RenderSettings underTheSky() {
  RenderSettings settings;
  settings.lighting.background = kSky;
  return settings;
}

TEST(BesideTheEye, GroundIsAsTheRaysSeeIt) {
  for (const float height_m : {0.06f, 0.1f, 0.3f}) {
    const SurfelCloud cloud = ground(height_m);
    for (const char* method : {"pinhole", "sweep", "sweep-lod:7", "auto"}) {
      const Frame frame =
          renderedBy(method, cloud, squareViewOf(kSize_px, kFocal_px), underTheSky());
      EXPECT_LT(largestDifference(frame, height_m), 0.05f) << method << ", " << height_m << " m";
    }
  }
}

TEST(BesideTheEye, GroundIsAsTheRaysSeeItOnTheGpu) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = ground(0.1f);
  Frame frame;
  makeMethod("sweep-lod:7", cloud, gpu)
      ->render(squareViewOf(kSize_px, kFocal_px), underTheSky(), frame);
  EXPECT_LT(largestDifference(frame, 0.1f), 0.05f);
}

TEST(BesideTheEye, WhatIsOnTheImageStaysThereAtAnyPlaceOfTheLens) {
  // A sheet beyond the left edge, which only its blur brings on the image, from every lens point.
  SurfelCloud cloud;
  addSheetOf(cloud, {.center_m = {-0.72f, 0.0f, -1.0f}, .samples = 40});
  const View view = squareViewOf(kSize_px, kFocal_px), wide = [&] {
    View wider = view;
    wider.size_px.x += 200;
    wider.principal_px.x += 200.0f;
    return wider;
  }();
  for (const char* method : {"sweep", "sweep-lod:7", "accumulate:16"}) {
    const Frame part = renderedBy(method, cloud, view, blurredBy(60.0f, 0.4f));
    const Frame whole = renderedBy(method, cloud, wide, blurredBy(60.0f, 0.4f));
    float light = 0.0f, apart = 0.0f;
    for (int y = 0; y < kSize_px; ++y) {
      for (int x = 0; x < kSize_px; ++x) {
        light = std::max(light, part.at(x, y).r);
        apart = std::max(apart, std::abs(part.at(x, y).r - whole.at(x + 200, y).r));
      }
    }
    EXPECT_GT(light, 0.1f) << method;
    EXPECT_LT(apart, 0.01f) << method;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
