// Small scenes, and measurements on their frames, for the tests of the renderers.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "base/quantile.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"

namespace foci {

inline RenderSettings blurredBy(float radius_px_per_D, float focus_D) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D), .focus_D = focus_D}};
}

inline View squareViewOf(int size_px, float focal_px) {
  return {.size_px = {size_px, size_px},
          .focal_px = glm::vec2(focal_px),
          .principal_px = glm::vec2(0.5f * static_cast<float>(size_px))};
}

inline Frame renderedBy(const char* method, const SurfelCloud& cloud, const View& view,
                        const RenderSettings& settings, RenderStats* stats = nullptr) {
  Frame frame;
  const RenderStats cost = makeMethod(method, cloud)->render(view, settings, frame);
  if (stats) *stats = cost;
  return frame;
}

/// What the differences of 95 % of the pixels stay below, just-noticeable differences.
inline float visibleErrorOf(const Frame& frame, const Frame& truth) {
  std::vector<float> apart = visibleDifference(frame, truth, kUsualPx_per_deg);
  return quantile(apart, 0.95);
}

struct Sheet {
  glm::vec3 center_m{0.0f, 0.0f, -1.0f};
  glm::vec3 right{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};  ///< unit
  float side_m = 0.4f;
  int samples = 160;
  glm::vec3 color{1.0f};
  float opacity = 1.0f;
};

inline void addSheetOf(SurfelCloud& cloud, const Sheet& sheet) {
  const float h_m = sheet.side_m / static_cast<float>(sheet.samples);
  const auto offset = [&](int i) {
    return (static_cast<float>(i) + 0.5f) * h_m - 0.5f * sheet.side_m;
  };
  for (int y = 0; y < sheet.samples; ++y) {
    for (int x = 0; x < sheet.samples; ++x) {
      appendSurfel(cloud, sheet.center_m + offset(x) * sheet.right + offset(y) * sheet.up,
                   glm::cross(sheet.right, sheet.up), kSigmaPerSpacing * h_m, h_m * h_m,
                   sheet.color, sheet.opacity);
    }
  }
}

/// Surfels with random places, orientations, sizes, colours and opacities in front of the eye.
inline SurfelCloud scattered(int n, unsigned seed, bool transparent) {
  std::mt19937 random(seed);
  const auto uniform = [&](float a, float b) {
    return a + (b - a) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
  };
  SurfelCloud cloud;
  for (int i = 0; i < n; ++i) {
    const float z_m = uniform(0.5f, 4.0f);
    const float x_m = uniform(-0.5f, 0.5f) * z_m, y_m = uniform(-0.5f, 0.5f) * z_m;
    const float nx = uniform(-1, 1), ny = uniform(-1, 1), nz = uniform(0.1f, 1);
    const float sigma_m = uniform(0.002f, 0.02f);
    const float r = uniform(0, 1), g = uniform(0, 1), b = uniform(0, 1);
    appendSurfel(cloud, {x_m, y_m, -z_m}, glm::normalize(glm::vec3(nx, ny, nz)), sigma_m,
                 4.0f * sigma_m * sigma_m, {r, g, b}, transparent ? uniform(0.2f, 1.0f) : 1.0f);
  }
  return cloud;
}

struct FrameMoments {
  double mass = 0.0, variance_x = 0.0, variance_y = 0.0;
};

/// Moments of the red channel, over pixel centres.
inline FrameMoments frameMoments(const Frame& frame) {
  const auto sum = [&](auto&& value) {
    double total = 0.0;
    for (int y = 0; y < frame.size_px.y; ++y) {
      for (int x = 0; x < frame.size_px.x; ++x) total += frame.at(x, y).r * value(x + 0.5, y + 0.5);
    }
    return total;
  };
  FrameMoments m;
  m.mass = sum([](double, double) { return 1.0; });
  const double x = sum([](double px, double) { return px; }) / m.mass;
  const double y = sum([](double, double py) { return py; }) / m.mass;
  m.variance_x = sum([&](double px, double) { return (px - x) * (px - x); }) / m.mass;
  m.variance_y = sum([&](double, double py) { return (py - y) * (py - y); }) / m.mass;
  return m;
}

}  // namespace foci
