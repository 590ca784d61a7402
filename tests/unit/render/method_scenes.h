// Small scenes with known answers, for the tests of depth-of-field methods.
#pragma once

#include <cmath>
#include <string_view>

#include "render/methods/method.h"

namespace foci {

/// A camera at the origin that looks along -z, with square pixels. Its axis meets the image's
/// middle.
inline View squareView(int size_px, float focal_px) {
  return {.size_px = {size_px, size_px},
          .focal_px = glm::vec2(focal_px),
          .principal_px = glm::vec2(0.5f * static_cast<float>(size_px))};
}

/// A lens that measures distance along the axis, so that a sheet across the axis has the same blur
/// everywhere.
inline RenderSettings lens(float radius_px_per_D, float focus_D) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D),
                      .focus_D = focus_D,
                      .along = DistanceAlong::axis}};
}

/// Adds a square sheet across the axis at depth `depth_m`: `n` x `n` surfels, `size_m` wide. Its
/// centre is `middle_m` to the right.
inline void addSheet(SurfelCloud& cloud, float depth_m, float size_m, int n, const glm::vec3& color,
                     float middle_m = 0.0f, float opacity = 1.0f) {
  const float h_m = size_m / static_cast<float>(n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      appendSurfel(cloud,
                   {middle_m + (static_cast<float>(x) + 0.5f) * h_m - 0.5f * size_m,
                    (static_cast<float>(y) + 0.5f) * h_m - 0.5f * size_m, -depth_m},
                   {0.0f, 0.0f, 1.0f}, kSigmaPerSpacing * h_m, h_m * h_m, color, opacity);
    }
  }
}

inline Frame render(std::string_view method, const auto& cloud, const View& view,
                    const RenderSettings& settings) {
  Frame frame;
  makeMethod(method, cloud)->render(view, settings, frame);
  return frame;
}

struct Moments {
  double mass = 0.0, variance_x_px2 = 0.0, variance_y_px2 = 0.0;
};

/// Moments of the red light of `frame` minus that of `without`.
inline Moments momentsOf(const Frame& frame, const Frame* without = nullptr) {
  double mass = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
  for (int py = 0; py < frame.size_px.y; ++py) {
    for (int px = 0; px < frame.size_px.x; ++px) {
      const double light = frame.at(px, py).r - (without ? without->at(px, py).r : 0.0f);
      mass += light;
      x += light * px;
      y += light * py;
      xx += light * px * px;
      yy += light * py * py;
    }
  }
  x /= mass;
  y /= mass;
  return {mass, xx / mass - x * x, yy / mass - y * y};
}

/// A tiny surfel 1 m away, nearly a point of light: its red light in the image sums to
/// `kPointMass`.
inline constexpr double kPointMass = 0.04;
inline constexpr float kPointFocal_px = 1000.0f;

/// @param shift_px  from the image's middle
inline SurfelCloud pointOfLight(const glm::vec2& shift_px) {
  SurfelCloud cloud;
  appendSurfel(cloud, {shift_px.x / kPointFocal_px, -shift_px.y / kPointFocal_px, -1.0f},
               {0.0f, 0.0f, 1.0f}, 1e-4f, 4e-8f, glm::vec3(1.0f));
  return cloud;
}
/// Variance of the sharp point: the prefilter's plus its own (0.1 mm at 1000 px a metre).
inline constexpr double kPointVariance_px2 = 1.01;

/// Moments of a point of light with a blur radius of `radius_px`, as a mean over 4 x 4 places
/// within a pixel. The focus is at infinity.
inline Moments momentsOfPoint(std::string_view method, float radius_px) {
  Moments mean;
  for (int place = 0; place < 16; ++place) {
    const SurfelCloud cloud = pointOfLight(0.25f * glm::vec2(place % 4, place / 4));
    const Moments m =
        momentsOf(render(method, cloud, squareView(257, kPointFocal_px), lens(radius_px, 0.0f)));
    mean.mass += m.mass / 16.0;
    mean.variance_x_px2 += m.variance_x_px2 / 16.0;
    mean.variance_y_px2 += m.variance_y_px2 / 16.0;
  }
  return mean;
}

/// A red half-plane 1 m away, left of the axis, in front of a green sheet 2 m away. The image has
/// 128 x 128 px, with the edge in the middle.
struct EdgeScene {
  static constexpr int kEdge_px = 64;
  /// Blur radius of the surface that is out of focus.
  static constexpr float kRadius_px = 8.0f;
  SurfelCloud cloud;
  View view = squareView(128, 300.0f);

  EdgeScene() {
    addSheet(cloud, 2.0f, 1.8f, 180, {0.0f, 1.0f, 0.0f});
    addSheet(cloud, 1.0f, 0.6f, 120, {1.0f, 0.0f, 0.0f}, -0.3f);
  }

  static RenderSettings nearInFocus() { return lens(2.0f * kRadius_px, 1.0f); }
  static RenderSettings farInFocus() { return lens(2.0f * kRadius_px, 0.5f); }

  /// Mean colour of the middle rows, `right_px` pixels right of the edge (negative: left).
  static glm::vec3 at(const Frame& frame, int right_px) {
    glm::vec3 sum(0.0f);
    for (int y = 48; y < 80; ++y) {
      sum += glm::vec3(frame.at(kEdge_px + right_px - (right_px < 0 ? 0 : 1), y));
    }
    return sum / 32.0f;
  }
};

}  // namespace foci
