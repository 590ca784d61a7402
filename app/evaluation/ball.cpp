// A closed, textured mesh made in code: a scene whose truth is known apart from its surfels.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <memory>
#include <utility>

#include "app/evaluation/scene_in_view.h"
#include "base/image_codec.h"
#include "render/optics/defocus.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/mesh/orientation.h"
#include "render/scene/mesh/sample_mesh.h"

namespace foci {
namespace {

// Chosen by eye: lumps of some ten degrees, and checks that 500,000 surfels resolve.
constexpr int kColumns = 192, kRows = 96;  // quads around the ball and from pole to pole
constexpr float kLump = 0.06f;             // of the radius
constexpr glm::ivec2 kTexture_px{512, 256};
constexpr int kCheck_px = 16;

constexpr float kRadius_m = 0.25f, kDistance_m = 1.0f;
constexpr double kFov_rad = 0.56;       // the ball, with its lumps, fills the image
constexpr glm::vec3 kBackground{0.8f};  // light, so that leaks and halos of dark checks show

glm::vec3 onBall(float u, float v) {
  const float around = glm::two_pi<float>() * u, down = glm::pi<float>() * v;
  const float sine = std::sin(down);
  const float radius = 1.0f + kLump * sine * sine * std::sin(6.0f * around) * std::sin(7.0f * down);
  return radius * glm::vec3(sine * std::sin(around), std::cos(down), sine * std::cos(around));
}

DecodedImage checks() {
  DecodedImage image{.columns = kTexture_px.x, .rows = kTexture_px.y};
  for (int y = 0; y < kTexture_px.y; ++y) {
    for (int x = 0; x < kTexture_px.x; ++x) {
      const bool light = (x / kCheck_px + y / kCheck_px) % 2 == 0;
      const auto along_x = static_cast<std::uint8_t>(255 * x / kTexture_px.x);
      const auto along_y = static_cast<std::uint8_t>(255 * y / kTexture_px.y);
      const std::array<std::uint8_t, 4> dark_rgba = {30, static_cast<std::uint8_t>(along_y / 2), 40,
                                                     255};
      const std::array<std::uint8_t, 4> light_rgba = {235, 215, along_x, 255};
      const auto& rgba = light ? light_rgba : dark_rgba;
      image.rgba.insert(image.rgba.end(), rgba.begin(), rgba.end());
    }
  }
  return image;
}

}  // namespace

TriangleMesh makeBallMesh(float radius_m) {
  TriangleMesh mesh;
  const auto add = [&](const glm::ivec2& corner) {
    const glm::vec2 size(kColumns, kRows), uv = glm::vec2(corner) / size;
    // The seam's two sides and all corners of a pole lie in one place, so that the ball is closed.
    const glm::ivec2 place(corner.y % kRows == 0 ? 0 : corner.x % kColumns, corner.y);
    mesh.corners_m.push_back(radius_m * onBall(static_cast<float>(place.x) / size.x, uv.y));
    mesh.uv.emplace_back(uv.x, 1.0f - uv.y);
  };
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kRows; ++j) {
      const glm::ivec2 a(i, j), b(i, j + 1), c(i + 1, j + 1), d(i + 1, j);
      if (j + 1 < kRows) {  // else b and c are the same pole
        for (const glm::ivec2& corner : {a, b, c}) add(corner);
      }
      if (j > 0) {
        for (const glm::ivec2& corner : {a, c, d}) add(corner);
      }
    }
  }
  mesh.material.resize(mesh.size(), 0);
  orientOutwards(mesh);
  mesh.materials = {{.texture = std::make_shared<const MeshTexture>(checks())}};
  return mesh;
}

SceneInView ballInView(int size_px) {
  auto mesh = std::make_shared<const TriangleMesh>(makeBallMesh(kRadius_m));
  SurfelCloud cloud = surfelsFromPoints(sampleMesh(*mesh, "ball"));
  cloud.mesh = std::move(mesh);
  RenderSettings settings;
  settings.defocus.focus_D = 1.0f / (kDistance_m - kRadius_m);
  settings.defocus.along = DistanceAlong::axis;  // a camera, as in the other scenes
  settings.lighting.background = kBackground;
  return {.name = "ball",
          .scene = {std::move(cloud)},
          .view = viewOfCamera(eyeFromWorld({0.0f, 0.0f, kDistance_m}, glm::vec3(0.0f), {0, 1, 0}),
                               glm::ivec2(size_px), kFov_rad),
          .settings = settings};
}

}  // namespace foci
