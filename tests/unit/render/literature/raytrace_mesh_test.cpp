// `raytrace` on the triangles of a mesh, held against closed forms.
#ifdef FOCI_RAYTRACE
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "render/methods/method.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {
namespace FOCI_FILE {

constexpr int kSize_px = 33;
constexpr float kDistance_m = 2.0f, kFocal_px = 100.0f;

SurfelCloud sceneOf(TriangleMesh mesh) {
  SurfelCloud cloud;
  mesh.material.resize(mesh.size(), 0);
  cloud.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
  return cloud;
}

/// The half-plane x < 0 at the distance `z_m`, large enough to fill the left of the image.
TriangleMesh halfPlane(float z_m, const glm::vec3& color, float opacity = 1.0f) {
  TriangleMesh mesh;
  mesh.corners_m = {{0, -9, -z_m}, {0, 9, -z_m},  {-9, 9, -z_m},
                    {0, -9, -z_m}, {-9, 9, -z_m}, {-9, -9, -z_m}};
  mesh.uv.resize(6);
  mesh.materials = {{.texture = {}, .factor = color, .opacity = opacity}};
  return mesh;
}

View viewOf() {
  return {.eye_from_world = glm::mat4(1.0f),
          .size_px = {kSize_px, kSize_px},
          .focal_px = glm::vec2(kFocal_px),
          .principal_px = glm::vec2(0.5f * kSize_px)};
}

Frame render(const SurfelCloud& scene, const RenderSettings& settings, int rays = 2000) {
  Frame frame;
  makeMethod("raytrace:" + std::to_string(rays), scene)->render(viewOf(), settings, frame);
  return frame;
}

/// Share of a uniform disc of radius 1 that lies at x < `x`.
double discShare(double x) {
  if (x <= -1.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return 1.0 - (std::acos(x) - x * std::sqrt(1.0 - x * x)) / M_PI;
}

TEST(RaytraceMesh, BlursAnEdgeAsADiscAndThePixelFilterDo) {
  for (const DistanceAlong along : {DistanceAlong::axis, DistanceAlong::sight}) {
    RenderSettings settings;
    settings.lighting.background = glm::vec3(1.0f);
    settings.defocus = {.radius_px_per_D = glm::vec2(24.0f), .focus_D = 0.25f, .along = along};
    const float radius_px = 24.0f * (1.0f / kDistance_m - 0.25f);  // 6 px
    const Frame frame = render(sceneOf(halfPlane(kDistance_m, glm::vec3(0.0f))), settings);
    for (int x = 4; x < kSize_px - 4; ++x) {
      // The filter (1 - r^2/8)^2 projected on an axis, (1 - t^2/8)^2.5, by numerical convolution.
      double covered = 0.0, weights = 0.0;
      for (int k = -200; k <= 200; ++k) {
        const double t = std::sqrt(8.0) * k / 200.0,
                     w = std::pow(std::max(1.0 - t * t / 8.0, 0.0), 2.5);
        weights += w;
        covered += w * (1.0 - discShare((x + 0.5 + t - 0.5 * kSize_px) / radius_px));
      }
      const auto middle = static_cast<std::size_t>(kSize_px / 2 * kSize_px + x);
      EXPECT_NEAR(frame.rgba[middle].a, covered / weights, 0.02) << x;  // noise of 2000 rays
      EXPECT_NEAR(frame.rgba[middle].r, 1.0 - covered / weights, 0.02) << x;
    }
  }
}

TEST(RaytraceMesh, SeesTheNearestTriangleAndThroughTransparentOnes) {
  TriangleMesh mesh = halfPlane(2.0f, {1.0f, 0.0f, 0.0f}, 0.25f);
  const TriangleMesh behind = halfPlane(3.0f, {0.0f, 1.0f, 0.0f});
  mesh.corners_m.insert(mesh.corners_m.end(), behind.corners_m.begin(), behind.corners_m.end());
  mesh.uv.resize(12);
  mesh.materials.push_back(behind.materials[0]);
  mesh.material = {0, 0, 1, 1};
  RenderSettings settings;
  settings.depth = true;
  const Frame frame = render(sceneOf(mesh), settings, 16);
  const std::size_t left = kSize_px / 2 * kSize_px + 4;
  EXPECT_NEAR(frame.rgba[left].r, 0.25f, 1e-4f);
  EXPECT_NEAR(frame.rgba[left].g, 0.75f, 1e-4f);
  EXPECT_FLOAT_EQ(frame.rgba[left].a, 1.0f);
  EXPECT_NEAR(frame.depth_m[left], 0.25f * 2.0f + 0.75f * 3.0f, 0.1f);  // along the slanted sight
}

TEST(RaytraceMesh, ClipsTrianglesThatReachBehindTheEye) {
  TriangleMesh floor;  // one metre below the eye, from far behind it to far in front
  floor.corners_m = {{-50, -1, 50}, {50, -1, 50}, {0, -1, -500}};
  floor.uv.resize(3);
  floor.materials = {{.texture = {}, .factor = glm::vec3(0.5f)}};
  const Frame frame = render(sceneOf(floor), {}, 16);
  for (int y = 0; y < kSize_px; ++y) {
    if (std::abs(y - kSize_px / 2) < 4) continue;  // the horizon
    const float expected = y > kSize_px / 2 ? 1.0f : 0.0f;
    EXPECT_EQ(frame.rgba[static_cast<std::size_t>(y * kSize_px + kSize_px / 2)].a, expected) << y;
  }
}

TEST(RaytraceMesh, ShowsAnEmptySceneAsBackground) {
  RenderSettings settings;
  settings.lighting.background = glm::vec3(0.5f);
  const Frame frame = render(sceneOf({}), settings, 2);
  for (const glm::vec4& pixel : frame.rgba) EXPECT_EQ(pixel, glm::vec4(0.5f, 0.5f, 0.5f, 0.0f));
}

}  // namespace FOCI_FILE
}  // namespace foci
#endif  // FOCI_RAYTRACE
