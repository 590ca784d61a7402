// The surfels of a mesh held against its triangles.
#include "app/prepare/fidelity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "base/quantile.h"
#include "render/methods/method.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/mesh/orientation.h"
#include "render/scene/mesh/sample_mesh.h"
#ifdef FOCI_RAYTRACE
#include "render/literature/raytrace/triangle_view.h"
#endif
#include "tests/cube_mesh.h"

namespace foci {
namespace FOCI_FILE {

constexpr std::size_t kViews = 8;  // of the 64; for speed

TEST(DirectionsOverSphere, AreEven) {
  const std::vector<glm::vec3> all = directionsOverSphere(kFidelityViews);
  ASSERT_EQ(all.size(), 64u);
  glm::vec3 sum(0.0f);
  float nearest = 2.0f;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(glm::length(all[i]), 1.0f, 1e-6f);
    sum += all[i];
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, glm::distance(all[i], all[j]));
  }
  EXPECT_LT(glm::length(sum) / 64.0f, 0.01f);
  // Hexagonal packing of 64 caps would leave sqrt(8 pi / (sqrt(3) 64)).
  EXPECT_GT(nearest, 0.75f * std::sqrt(8.0f * std::numbers::pi_v<float> / (1.732f * 64.0f)));
}

TEST(LeakColor, RisesInLightness) {
  double before = 0.0;
  for (int i = 0; i <= 10; ++i) {
    const auto color = leakColor(kLeak + 0.01f * static_cast<float>(i));
    const double light = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
    EXPECT_GT(light, before);
    before = light;
  }
}

TEST(FidelityWarnings, NameTheFigureAndTheNumberOfPoints) {
  const TriangleMesh mesh = makeBallMesh(1.0f);
  const auto wanted = std::to_string(defaultPoints(mesh));  // 500,000
  FidelityReport report{.pixel_m = 1.0, .spacing_m = 1.0};
  report.all = {.interior = 1'000'000, .leaking = 100, .largest_leak = 0.15f, .color_99 = 26.0};
  EXPECT_TRUE(fidelityWarnings(report, 1000, mesh).empty());  // the goals themselves are met

  report.all.leaking = 3000;
  auto warnings = fidelityWarnings(report, 1000, mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("0.300 %"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("set --points " + wanted), std::string::npos) << warnings[0];
  warnings = fidelityWarnings(report, 450'000, mesh);
  EXPECT_NE(warnings.at(0).find("try --points 1800000"), std::string::npos) << warnings[0];
  report.spacing_m = 0.4;
  warnings = fidelityWarnings(report, 450'000, mesh);
  EXPECT_EQ(warnings.at(0).find("--points"), std::string::npos) << warnings[0];

  report.all.leaking = 0;
  report.all.color_99 = 40.0;
  EXPECT_TRUE(fidelityWarnings(report, 450'000, mesh).empty());  // as many as the detail asks for
  warnings = fidelityWarnings(report, 100'000, mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("40 of 255"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find(wanted), std::string::npos) << warnings[0];
}

#ifdef FOCI_RAYTRACE

struct Prepared {
  SurfelCloud cloud;
  double spacing_m;
};

Prepared prepared(const TriangleMesh& mesh, const MeshSampling& sampling,
                  KernelSolve solve = KernelSolve::quick) {
  SurfelCloud cloud = surfelsFromPoints(sampleMesh(mesh, "mesh", sampling), {.solve = solve});
  std::vector<float> area_m2(cloud.area_m2.begin(), cloud.area_m2.end());
  const double spacing_m = std::sqrt(double{quantile(area_m2, 0.5)});
  return {std::move(cloud), spacing_m};
}

TriangleMesh square(float side_m, const MeshMaterial& material) {
  const float h = 0.5f * side_m;
  TriangleMesh mesh;
  mesh.corners_m = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  mesh.uv.resize(6);
  mesh.material = {0, 0};
  mesh.materials = {material};
  return mesh;
}

/// A camera 4 m before the origin.
View viewOf(int size_px, float focal_px) {
  return {.eye_from_world = eyeFromWorld({0, 0, 4}, glm::vec3(0.0f), {0, 1, 0}),
          .size_px = glm::ivec2(size_px),
          .focal_px = glm::vec2(focal_px),
          .principal_px = glm::vec2(0.5f * static_cast<float>(size_px))};
}

// 2 m at 4 m and 101.3 px: 50.65 px, so that the edges lie at odd parts of pixels.
TEST(TriangleView, OfASquareHasItsAreaItsOutlineAndItsInterior) {
  constexpr double kSide_px = 50.65;
  const glm::vec3 color(0.2f, 0.5f, 0.9f);
  const TriangleMesh mesh = square(2.0f, {.texture = {}, .factor = color});
  const MeshRays rays(mesh);
  const TriangleView seen = triangleView(rays, viewOf(80, static_cast<float>(2.0 * kSide_px)));
  double area_px = 0.0;
  std::size_t interior = 0;
  for (std::size_t p = 0; p < seen.interior.size(); ++p) {
    const glm::vec4& rgba = seen.frame.rgba[p];
    area_px += rgba.a;
    interior += seen.interior[p];
    if (seen.interior[p] != 0) {
      EXPECT_NEAR(rgba.a, 1.0f, 1e-5f);
      EXPECT_NEAR(rgba.b, 0.9f, 1e-5f);
    }
    EXPECT_FALSE(seen.interior[p] != 0 && seen.outline[p] != 0);
  }
  EXPECT_NEAR(area_px, kSide_px * kSide_px, 0.5 * kSide_px);  // four edges, each 1/8 px off at most
  // The filter, of a standard deviation of 1 px, rounds each corner by about a pixel.
  EXPECT_NEAR(outlineLength_px(seen.frame, seen.outline), 4.0 * kSide_px, 6.0);
  const double inner_px = std::floor(kSide_px) - 1.0 - 2.0 * kFilterReach_px;
  EXPECT_NEAR(std::sqrt(static_cast<double>(interior)), inner_px, 1.0);
  EXPECT_EQ(seen.transparent, 0u);
}

TEST(Fidelity, OfTheTrianglesThemselvesIsExactAndOfAShiftTheShift) {
  constexpr float kSide_px = 50.0f;
  const TriangleMesh mesh = square(2.0f, {.texture = {}, .factor = glm::vec3(0.5f)});
  const TriangleView truth = triangleView(MeshRays(mesh), viewOf(80, 2.0f * kSide_px));
  const Fidelity same = fidelityOf(truth, truth.frame);
  EXPECT_EQ(same.leaking, 0u);
  EXPECT_LT(same.largest_leak, 1e-5f);
  EXPECT_EQ(same.color_mean, 0.0);
  EXPECT_EQ(same.color_99, 0.0);
  EXPECT_EQ(same.outline_px, 0.0);

  // A pixel to the right: two of four edges lie a pixel off, one in and one out.
  Frame moved = truth.frame;
  std::rotate(moved.rgba.begin(), moved.rgba.end() - 1, moved.rgba.end());
  const Fidelity shifted = fidelityOf(truth, moved);
  EXPECT_NEAR(shifted.outline_px.value(), 0.5, 0.03);
  EXPECT_NEAR(shifted.outline_shift_px.value(), 0.0, 1e-3);

  // A tenth of the light behind shows everywhere: white adds 0.1, and black takes 0.05.
  Frame leaking = truth.frame;
  for (glm::vec4& rgba : leaking.rgba) rgba *= 0.9f;
  const Fidelity leaks = fidelityOf(truth, leaking);
  EXPECT_EQ(leaks.leakShare(), 1.0);
  EXPECT_NEAR(leaks.largest_leak, 0.1f, 1e-5f);
  EXPECT_NEAR(leaks.color_mean.value(), 9.0, 2.0);  // sRGB(0.5) = 188, sRGB(0.45) = 179, 0.55: 196
}

TEST(TriangleView, CountsNoTransparentPixelAsInterior) {
  const TriangleMesh mesh =
      square(2.0f, {.texture = {}, .factor = glm::vec3(1.0f), .opacity = 0.4f});
  const TriangleView seen = triangleView(MeshRays(mesh), viewOf(80, 100.0f));
  EXPECT_EQ(std::count(seen.interior.begin(), seen.interior.end(), 1), 0);
  EXPECT_GT(seen.transparent, 1000u);
  EXPECT_NEAR(seen.frame.at(40, 40).a, 0.4f, 1e-5f);
}

// The same surfaces, found by rays that are built for one view and pass through any lens.
TEST(TriangleView, AgreesWithTheReferenceMethod) {
  const TriangleMesh mesh = makeBallMesh(0.9f);
  const View view = viewOf(64, 120.0f);
  SurfelCloud cloud;
  cloud.mesh = std::make_shared<const TriangleMesh>(mesh);
  Frame expected;
  makeMethod("raytrace:400", cloud)->render(view, {}, expected);
  const TriangleView seen = triangleView(MeshRays(mesh), view);
  double apart = 0.0;
  for (std::size_t p = 0; p < expected.rgba.size(); ++p) {
    const glm::vec4 difference = glm::abs(expected.rgba[p] - seen.frame.rgba[p]);
    apart += difference.r + difference.g + difference.b + difference.a;
    EXPECT_LT(difference.a, 0.06f);  // 400 random rays: 3 sigma are 0.06 where half hit
  }
  EXPECT_LT(apart / 4.0 / static_cast<double>(expected.rgba.size()), 0.006);
}

// Coverage is what a white background loses: the leak that a user sees.
TEST(Fidelity, CoverageIsOneMinusWhatWhiteAddsToBlack) {
  const TriangleMesh mesh = makeBallMesh(1.0f);
  const Prepared sparse = prepared(mesh, {.points = 300});
  const auto method = makeMethod("pinhole", sparse.cloud);
  const View view = viewFromOutside(boundingSphereOf(mesh), {0, 0, 1}, {0.9f, 0, 0});
  EXPECT_EQ(view.size_px, glm::ivec2(kFidelity_px));
  RenderSettings before_white;
  before_white.lighting.background = glm::vec3(1.0f);
  Frame black, white;
  method->render(view, {}, black);
  method->render(view, before_white, white);
  float largest = 0.0f;
  for (std::size_t p = 0; p < black.rgba.size(); ++p) {
    EXPECT_NEAR(white.rgba[p].g - black.rgba[p].g, 1.0f - black.rgba[p].a, 1e-5f);
    largest = std::max(largest, black.rgba[p].a);
  }
  EXPECT_EQ(largest, 1.0f);
}

TEST(Fidelity, ALumpyBallOfDefaultPointsMeetsTheGoals) {
  const TriangleMesh mesh = makeBallMesh(0.25f);
  const Prepared ball = prepared(mesh, {});
  const auto report = measureFidelity(ball.cloud, mesh, ball.spacing_m, kViews);
  ASSERT_TRUE(report);
  EXPECT_GT(report->all.interior, 100'000u);
  EXPECT_LE(report->all.leakShare(), kMaxLeakShare);
  EXPECT_LE(report->all.largest_leak, kWorstLeak);
  EXPECT_LT(report->all.color_mean.value(), 5.0);
  EXPECT_LT(report->all.outline_px.value(), 1.0);
  EXPECT_TRUE(fidelityWarnings(*report, ball.cloud.size(), mesh).empty());
}

/// The edges of a cube once leaked in 0.09 % of the pixels, by up to 36 %: each face was solved as
/// if its surface ended there.
TEST(Fidelity, ACubeLeaksLittleAtItsCreases) {
  TriangleMesh mesh;
  addCube(mesh, {}, 1.0f);
  EXPECT_EQ(orientOutwards(mesh), 0u);
  const Prepared cube = prepared(mesh, {}, KernelSolve::thorough);
  const auto report = measureFidelity(cube.cloud, mesh, cube.spacing_m, 2 * kViews);
  ASSERT_TRUE(report);
  EXPECT_GT(report->all.interior, 100'000u);
  EXPECT_LE(report->all.leakShare(), 2.0 * kMaxLeakShare);
  EXPECT_LE(report->all.largest_leak, 0.2f);
}

TEST(Fidelity, WarnsOfABallWithFarTooFewPointsAndIsTheSameEveryTime) {
  const TriangleMesh mesh = makeBallMesh(0.25f);
  const Prepared ball = prepared(mesh, {.points = 200});
  const auto report = measureFidelity(ball.cloud, mesh, ball.spacing_m, kViews);
  ASSERT_TRUE(report);
  EXPECT_GT(report->all.leakShare(), 10.0 * kMaxLeakShare);
  EXPECT_GT(report->all.outline_px.value(), 1.0);
  const auto warnings = fidelityWarnings(*report, ball.cloud.size(), mesh);
  ASSERT_EQ(warnings.size(), 2u);  // the checks are lost, too
  const auto again = measureFidelity(ball.cloud, mesh, ball.spacing_m, kViews);
  EXPECT_EQ(fidelityWarnings(*again, ball.cloud.size(), mesh), warnings);
  EXPECT_EQ(again->difference.rgb, report->difference.rgb);
}

#endif  // FOCI_RAYTRACE

}  // namespace FOCI_FILE
}  // namespace foci
