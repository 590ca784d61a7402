// Captured scenes of Gaussians. They are not part of the project: tests skip where they are absent.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "render/methods/method.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"
#include "tests/unit/render/read_gaussians.h"

namespace foci {

inline std::filesystem::path captureNamed(const std::string& name) {
  const char* folder = std::getenv("FOCI_DATA");
  const std::filesystem::path data =
      folder ? folder : std::filesystem::path(FOCI_SOURCE_DIR).parent_path() / "shared/data";
  return data / "splats" / name;
}

/// A capture that stands on the ground, and an eye that sees all of it.
struct Captured {
  GaussianCloud scene;
  View view;
  float nearest_m = 0.0f, farthest_m = 0.0f;  // of the middle 96 % of its Gaussians

  Captured(const std::string& name, int size_px) {
    GaussianFile file = *readGaussians(captureNamed(name));
    const float up = file.y_is_up ? 1.0f : -1.0f;
    const auto quantilesOf = [&](const auto& valueOf) {
      std::vector<float> values;
      for (const glm::vec3& p : file.cloud.position_m) values.push_back(valueOf(p));
      std::ranges::sort(values);
      return std::pair(values[values.size() / 50], values[values.size() - values.size() / 50]);
    };
    const auto [left, right] = quantilesOf([](const glm::vec3& p) { return p.x; });
    const auto [low, high] = quantilesOf([](const glm::vec3& p) { return p.y; });
    const auto [back, front] = quantilesOf([](const glm::vec3& p) { return p.z; });
    const float height = high - low;
    const glm::vec3 middle = 0.5f * glm::vec3(left + right, low + high, back + front);
    const glm::vec3 eye = middle + 1.2f * height * glm::vec3(0.5f, 0.0f, up);
    view = squareView(size_px,
                      0.9f * static_cast<float>(size_px) * glm::length(eye - middle) / height);
    view.eye_from_world = eyeFromWorld(eye, middle, {0.0f, up, 0.0f});
    std::tie(nearest_m, farthest_m) =
        quantilesOf([&](const glm::vec3& p) { return glm::distance(p, eye); });
    scene = std::move(file.cloud);
  }

  /// In focus near its front, with blur up to this radius.
  RenderSettings settings(float blur_px) const {
    const float focus_D = 1.0f / (nearest_m + 0.15f * (farthest_m - nearest_m));
    const float off_D = std::max(1.0f / nearest_m - focus_D, focus_D - 1.0f / farthest_m);
    return {.defocus = {.radius_px_per_D = glm::vec2(blur_px / off_D), .focus_D = focus_D}};
  }
};

/// Another focus, nearer than all of it: the blur radius is `blur_px` at its front, more behind.
inline RenderSettings blurredEverywhere(const Captured& capture, float blur_px) {
  const float near_D = 1.0f / capture.nearest_m, far_D = 1.0f / capture.farthest_m;
  const float focus_D = near_D + 4.0f * (near_D - far_D);
  return {
      .defocus = {.radius_px_per_D = glm::vec2(blur_px / (focus_D - near_D)), .focus_D = focus_D}};
}

}  // namespace foci
