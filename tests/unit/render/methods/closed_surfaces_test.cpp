// No background shows through a closed surface: black meshes before white, held against rays
// through their triangles. None of these meshes is one that constants were chosen on.
#ifdef FOCI_RAYTRACE
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "render/methods/method.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/unit/render/mesh_shapes.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr glm::ivec2 kSize_px{200, 150};
constexpr std::size_t kPoints = 40'000;  // a pixel apart, about
constexpr float kLeak = 0.05f, kWorst = 0.15f;
constexpr double kShare = 1e-4;  // of interior pixels that may leak more than kLeak
constexpr int kErode_px = 3;     // the kernel's reach

using Surface = std::function<glm::vec3(float u, float v)>;

TriangleMesh meshOf(const Surface& surface, int columns, int rows) {
  TriangleMesh mesh;
  const auto at = [&](int i, int j) {
    return surface(static_cast<float>(i) / static_cast<float>(columns),
                   static_cast<float>(j) / static_cast<float>(rows));
  };
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const glm::vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const glm::vec3& corner : {a, b, c, a, c, d}) mesh.corners_m.push_back(corner);
    }
  }
  mesh.uv.resize(mesh.corners_m.size());
  mesh.material.resize(mesh.size(), 0);
  mesh.materials = {{.texture = {}, .factor = glm::vec3(0.0f)}};
  return mesh;
}

glm::vec3 onSphere(float u, float v, float radius) {
  const float phi = glm::two_pi<float>() * u, theta = glm::pi<float>() * v;
  return radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                            -std::sin(theta) * std::sin(phi));
}

struct Shape {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Shape> shapes() {
  const float tau = glm::two_pi<float>();
  const auto smooth = [](float u, float v) { return onSphere(u, v, 1.0f); };
  const auto bumps = [&](float u, float v) {
    const float sine = std::sin(glm::pi<float>() * v);
    return onSphere(u, v, 1.0f + 0.06f * sine * std::sin(12 * tau * u) * std::sin(11 * tau * v));
  };
  const auto star = [&](float u, float v) {
    const float sine = std::sin(glm::pi<float>() * v);
    return onSphere(u, v, 1.0f + 0.4f * sine * sine * std::cos(5 * tau * u));
  };
  const auto torus = [&](float u, float v) {
    const float ring = 1.0f + 0.3f * std::cos(tau * v);
    return glm::vec3(ring * std::cos(tau * u), 0.3f * std::sin(tau * v), ring * std::sin(tau * u));
  };
  const auto sheet = [&](float u, float v) {
    return glm::vec3(2 * u - 1, 0.03f * std::sin(9 * tau * u) * std::cos(8 * tau * v), 1 - 2 * v);
  };
  const auto folds = [&](float u, float v) {
    const float saw = std::abs(std::fmod(14.0f * u, 2.0f) - 1.0f);
    return glm::vec3(2 * u - 1, 0.12f * saw, 1 - 2 * v);
  };
  return {{"sphere", meshOf(smooth, 60, 40)},   {"bumps", meshOf(bumps, 240, 120)},
          {"star", meshOf(star, 120, 60)},      {"torus", meshOf(torus, 120, 40)},
          {"ripples", meshOf(sheet, 150, 150)}, {"folds", meshOf(folds, 140, 40)}};
}

struct Leak {
  double share = 0.0;
  float worst = 0.0f;
  std::size_t interior = 0;
};

/// Light of the background at pixels around which the truth has none.
Leak leakOf(const Frame& frame, const Frame& truth) {
  Leak leak;
  std::size_t leaking = 0;
  for (int y = kErode_px; y < kSize_px.y - kErode_px; ++y) {
    for (int x = kErode_px; x < kSize_px.x - kErode_px; ++x) {
      float least = 1.0f;
      for (int k = 0; k < (2 * kErode_px + 1) * (2 * kErode_px + 1); ++k) {
        const int dx = k % (2 * kErode_px + 1) - kErode_px,
                  dy = k / (2 * kErode_px + 1) - kErode_px;
        const auto p = static_cast<std::size_t>((y + dy) * kSize_px.x + x + dx);
        least = std::min(least, truth.rgba[p].a);
      }
      if (least < 0.9999f) continue;
      const float light = frame.rgba[static_cast<std::size_t>(y * kSize_px.x + x)].r;
      ++leak.interior;
      leaking += light > kLeak;
      leak.worst = std::max(leak.worst, light);
    }
  }
  leak.share =
      static_cast<double>(leaking) / static_cast<double>(std::max<std::size_t>(leak.interior, 1));
  return leak;
}

View viewFrom(float elevation, float azimuth) {
  const glm::vec3 towards(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                          std::cos(elevation) * std::cos(azimuth));
  return viewOfCamera(eyeFromWorld(5.0f * towards, glm::vec3(0.0f), {0, 1, 0}), kSize_px, 0.5);
}

/// Holds images of a shape against rays through its triangles.
/// @return how many
std::size_t expectNoLeaks(const Shape& shape, const std::vector<const char*>& methods,
                          const std::vector<float>& elevations, const std::vector<float>& blurs_px,
                          std::size_t points = kPoints, double most = kShare) {
  SurfelCloud cloud = surfelsFromPoints(sampleMesh(shape.mesh, shape.name, {.points = points}));
  cloud.mesh = std::make_shared<const TriangleMesh>(shape.mesh);
  const auto truth = makeMethod("raytrace:16", cloud);
  std::size_t images = 0;
  for (const float elevation : elevations) {
    const View view = viewFrom(elevation, 0.5f + elevation);
    for (const float blur_px : blurs_px) {
      RenderSettings settings;
      settings.lighting.background = glm::vec3(1.0f);
      settings.defocus.radius_px_per_D = glm::vec2(5.0f * blur_px);  // focus at infinity
      Frame expected, frame;
      truth->render(view, settings, expected);
      for (const char* method : methods) {
        makeMethod(method, cloud)->render(view, settings, frame);
        const Leak leak = leakOf(frame, expected);
        const std::string where = std::string(shape.name) + ", " + method + ", blur " +
                                  std::to_string(blur_px) + ", elevation " +
                                  std::to_string(elevation);
        EXPECT_GT(leak.interior, 500u) << where;
        EXPECT_LE(leak.share, most) << where;
        EXPECT_LE(leak.worst, kWorst) << where;
        ++images;
      }
    }
  }
  return images;
}

TEST(ClosedSurfaces, LeakNoBackgroundAtAnyLevelAndBlur) {
  std::size_t images = 0;
  for (const Shape& shape : shapes()) {
    images +=
        expectNoLeaks(shape, {"sweep", "auto:2", "auto:3", "auto:4", "auto:6", "auto:7", "auto:8"},
                      {-0.25f, 0.35f}, {0.0f, 3.0f});
  }
  EXPECT_GE(images, 100u);
}

/// 1.6 m wide and high.
TriangleMesh plateOf(float thick_m) {
  TriangleMesh mesh;
  addBox(mesh, glm::vec3(0.0f), {1.6f, 1.6f, thick_m});
  return finishedMesh(std::move(mesh), glm::vec3(0.0f));
}

/// The far side is near enough to be taken for the same sheet, and is not rendered.
TEST(ClosedSurfaces, LeakNoBackgroundWhereABodyIsThin) {
  for (const float thick_m : {0.03f, 0.01f, 0.003f, 0.0001f}) {
    expectNoLeaks({"plate", plateOf(thick_m)}, {"sweep", "auto:4"}, {0.2f, 0.35f}, {0.0f, 3.0f});
  }
}

double coverageOf_px(const Frame& frame) {
  double sum = 0.0;
  for (const glm::vec4& pixel : frame.rgba) sum += static_cast<double>(pixel.a);
  return sum;
}

/// At crests the kernels sum to less than one. Here the surfels lie 1.7 pixels apart, so more shows
/// than where they lie a pixel apart.
TEST(ClosedSurfaces, LeakNoBackgroundAtCrests) {
  const float tau = glm::two_pi<float>();
  const auto crests = [&](float u, float v) {
    const float waves = std::sin(7 * tau * u + 2 * std::sin(3 * tau * v)) * std::cos(9 * tau * v);
    const float fine = std::sin(19 * tau * (u + v));
    return glm::vec3(2 * u - 1, 0.025f * waves + 0.015f * fine, 1 - 2 * v);
  };
  constexpr std::size_t kFewPoints = 15'000;
  constexpr double kMagnified = 5.0 * kShare;
  const Shape shape{"crests", meshOf(crests, 240, 240)};
  expectNoLeaks(shape, {"sweep", "auto:4"}, {0.35f, 0.6f, 1.2f}, {0.0f}, kFewPoints, kMagnified);
  // With lens points no hole is closed, but kernels are wider.
  expectNoLeaks(shape, {"sweep", "auto:4"}, {0.6f, 1.2f}, {1.0f, 2.0f}, kFewPoints,
                2.0 * kMagnified);
}

/// Kernels of closed bodies reach a little farther, by the blur of the whole lens.
TEST(ClosedSurfaces, PartsAndPointsOfAnAstigmaticLensAgree) {
  constexpr double kSampling = 0.2;  // of the lens, just-noticeable differences
  TriangleMesh mesh;
  for (int i = 0; i < 100; ++i) {
    addBox(mesh,
           {0.2f * static_cast<float>(i % 10 - 5), 0.2f * static_cast<float>(i / 10 - 5), 0.0f},
           glm::vec3(0.1f));
  }
  mesh = finishedMesh(std::move(mesh), glm::vec3(0.0f));
  const SurfelCloud cloud = surfelsFromPoints(sampleMesh(mesh, "boxes", {.points = kPoints}));
  ASSERT_FALSE(cloud.bodies.of_surfel.empty());
  RenderSettings settings;
  settings.lighting.background = glm::vec3(1.0f);
  settings.defocus = {.radius_px_per_D = glm::vec2(10.0f), .astigmatism_D = {0.2f, 0.1f}};
  const View view = viewFrom(0.2f, 0.5f);
  EXPECT_LT(visibleErrorOf(renderedBy("sweep:37", cloud, view, settings),
                           renderedBy("accumulate:300", cloud, view, settings)),
            kSampling);
}

/// Where leaves partly hide each other, each point of the lens sees others, at a blur of a few
/// pixels, too.
TEST(ClosedSurfaces, FoliageWithALittleBlurIsAsViewsShowIt) {
  constexpr double kError = 0.6, kPredicted = 1.5;  // just-noticeable differences; over the error
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place_m(-0.8f, 0.8f);
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 at(place_m(random), place_m(random), place_m(random));
    addBox(mesh, at, i % 2 == 0 ? glm::vec3(0.15f, 0.04f, 0.01f) : glm::vec3(0.04f, 0.15f, 0.01f));
  }
  mesh = finishedMesh(std::move(mesh), glm::vec3(0.0f));
  const SurfelCloud cloud = surfelsFromPoints(sampleMesh(mesh, "leaves", {.points = kPoints}));
  RenderSettings settings;
  settings.lighting.background = glm::vec3(1.0f);
  settings.defocus = {.radius_px_per_D = glm::vec2(75.0f), .focus_D = 1.0f / 5.0f};
  settings.quality.check = ErrorCheck::of_still;
  const View view = viewFrom(0.1f, 0.1f);
  RenderStats stats;
  const Frame frame = renderedBy("auto", cloud, view, settings, &stats);
  const double error = visibleErrorOf(frame, renderedBy("accumulate:300", cloud, view, settings));
  EXPECT_EQ(stats.quality_level, QualityLevel::fine);
  EXPECT_LT(error, kError);
  EXPECT_GE(stats.tolerance_error.value_or(0.0), error);
  EXPECT_LE(stats.tolerance_error.value_or(0.0), kPredicted * error);
}

/// How far the outline of a rectangle moves out, by its area over its length. Samples are denser
/// beside a border, and kernels reach beyond it.
TEST(OpenSurfaces, KeepTheirOutlines) {
  constexpr double kMoves = 0.15;    // of a spacing
  constexpr double kRamp_px = 0.06;  // `kSharpRamp` at an edge of a pixel's filter
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
    mesh.corners_m.emplace_back(0.7f * static_cast<float>(x), 0.5f * static_cast<float>(y), 0.0f);
  }
  mesh = finishedMesh(std::move(mesh), glm::vec3(0.0f));
  const View view = viewFrom(0.0f, 0.0f);
  const double px_per_m = static_cast<double>(view.focal_px.x) / 5.0;
  const double area_px2 = 1.4 * 1.0 * px_per_m * px_per_m, length_px = 2 * (1.4 + 1.0) * px_per_m;
  for (const std::size_t points : {400u, 2'000u, 10'000u}) {
    const SurfelCloud cloud = surfelsFromPoints(sampleMesh(mesh, "rectangle", {.points = points}));
    Frame frame;
    makeMethod("pinhole", cloud)->render(view, {}, frame);
    const double spacing_px = std::sqrt(area_px2 / static_cast<double>(points));
    const double moved_px = (coverageOf_px(frame) - area_px2) / length_px;
    EXPECT_NEAR(moved_px, 0.0, kRamp_px + kMoves * spacing_px) << points;
  }
}

/// A board of a few pixels under a large blur: nodes hold all of its sides, and the front shows.
/// Half of their area is 1.125 times the front.
TEST(ClosedSurfaces, ABoardOfAFewPixelsKeepsItsLight) {
  constexpr double kError = 0.25;
  for (const float wide_m : {0.02f, 0.04f}) {
    TriangleMesh board;
    addBox(board, glm::vec3(0.0f), {wide_m, 1.2f, 0.125f * wide_m});
    const auto mesh =
        std::make_shared<const TriangleMesh>(finishedMesh(std::move(board), glm::vec3(0.0f)));
    SurfelCloud cloud = surfelsFromPoints(sampleMesh(*mesh, "board", {.points = kPoints}));
    cloud.mesh = mesh;
    RenderSettings settings;
    settings.lighting.background = glm::vec3(1.0f);
    settings.defocus.radius_px_per_D = glm::vec2(5.0f * 18.0f);  // focus at infinity
    Frame truth, frame;
    makeMethod("raytrace:64", cloud)->render(viewFrom(0.0f, 0.1f), settings, truth);
    const double expected_px = coverageOf_px(truth);
    for (const char* method : {"sweep-lod", "auto"}) {
      makeMethod(method, cloud)->render(viewFrom(0.0f, 0.1f), settings, frame);
      EXPECT_NEAR(coverageOf_px(frame) / expected_px, 1.0, kError) << method << ", " << wide_m;
    }
  }
}

/// The turns of a coil cover each other's outlines. The blurred levels of the whole aperture leak
/// there (docs/methods.md).
TEST(ClosedSurfaces, LeakNoBackgroundWhereOutlinesMeet) {
  const float tau = glm::two_pi<float>();
  const auto coil = [&](float u, float v) {
    const float around = 3 * tau * u, ring = 0.8f + 0.12f * std::cos(tau * v);
    return glm::vec3(ring * std::cos(around), 0.84f * u - 0.42f + 0.12f * std::sin(tau * v),
                     ring * std::sin(around));
  };
  const Shape shape{"coil", meshOf(coil, 240, 24)};
  expectNoLeaks(shape, {"sweep", "auto:2", "auto:3", "auto:4"}, {-0.25f, 0.2f, 0.35f}, {0.0f});
  expectNoLeaks(shape, {"auto:4", "auto:5", "auto:6"}, {0.2f, 0.35f}, {3.0f});
}

}  // namespace FOCI_FILE
}  // namespace foci
#endif  // FOCI_RAYTRACE
