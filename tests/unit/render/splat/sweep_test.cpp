#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "render/methods/method.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kMomentTolerance =
    0.02;  // sampling of the kernel at pixel centres, mean of 16 places
constexpr double kEnergyTolerance = 0.01;   // sampling, as above
constexpr double kOutlineTolerance = 0.01;  // sampling
constexpr float kSimdTolerance =
    2e-5f;  // fused against separate rounding, sums of some hundred terms

RenderSettings sharp() { return {}; }

RenderSettings blurred(float radius_px_per_D, float focus_D) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D), .focus_D = focus_D}};
}

View squareView(int size_px, float focal_px) {
  return {.size_px = {size_px, size_px},
          .focal_px = glm::vec2(focal_px),
          .principal_px = glm::vec2(0.5f * static_cast<float>(size_px))};
}

Frame render(const SurfelCloud& cloud, const View& view, const RenderSettings& settings,
             RenderStats* stats = nullptr) {
  Frame frame;
  const RenderStats cost = makeMethod("sweep", cloud)->render(view, settings, frame);
  if (stats) *stats = cost;
  return frame;
}

/// A square sheet facing the eye at `z_m`, `n` x `n` surfels over `size_m`.
void addSquareSheet(SurfelCloud& cloud, float z_m, float size_m, int n, const glm::vec3& color,
                    float opacity = 1.0f, float left_m = 0.0f) {
  const float h_m = size_m / static_cast<float>(n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      appendSurfel(cloud,
                   {left_m + (static_cast<float>(x) + 0.5f) * h_m - 0.5f * size_m,
                    (static_cast<float>(y) + 0.5f) * h_m - 0.5f * size_m, z_m},
                   {0.0f, 0.0f, 1.0f}, kSigmaPerSpacing * h_m, h_m * h_m, color, opacity);
    }
  }
}

/// Surfels of random place, orientation, size, colour and opacity in front of the eye.
SurfelCloud randomCloud(int n, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float a, float b) {
    return a + (b - a) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
  };
  SurfelCloud cloud;
  for (int i = 0; i < n; ++i) {
    const float z_m = uniform(0.5f, 4.0f);
    const glm::vec3 normal =
        glm::normalize(glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(0.1f, 1)));
    const float sigma_m = uniform(0.002f, 0.02f);
    appendSurfel(cloud, {uniform(-0.5f, 0.5f) * z_m, uniform(-0.5f, 0.5f) * z_m, -z_m}, normal,
                 sigma_m, 4.0f * sigma_m * sigma_m, {uniform(0, 1), uniform(0, 1), uniform(0, 1)},
                 uniform(0.2f, 1.0f));
  }
  return cloud;
}

struct Moments {
  double mass = 0.0, variance_x = 0.0, variance_y = 0.0;
};

Moments momentsOfRed(const Frame& frame) {
  Moments m;
  double x = 0.0, y = 0.0;
  const auto sum = [&](auto&& value) {
    double total = 0.0;
    for (int py = 0; py < frame.size_px.y; ++py) {
      for (int px = 0; px < frame.size_px.x; ++px)
        total += frame.at(px, py).r * value(px + 0.5, py + 0.5);
    }
    return total;
  };
  m.mass = sum([](double, double) { return 1.0; });
  x = sum([](double px, double) { return px; }) / m.mass;
  y = sum([](double, double py) { return py; }) / m.mass;
  m.variance_x = sum([&](double px, double) { return (px - x) * (px - x); }) / m.mass;
  m.variance_y = sum([&](double, double py) { return (py - y) * (py - y); }) / m.mass;
  return m;
}

/// Mean over 4 x 4 places within a pixel of the moments of one small, dim surfel 1 m away.
Moments pointOfLight(const RenderSettings& settings) {
  constexpr float kFocal_px = 1000.0f, kSigma_m = 1e-4f, kArea_m2 = 4e-8f;
  Moments mean;
  for (int place = 0; place < 16; ++place) {
    SurfelCloud cloud;
    appendSurfel(cloud,
                 {static_cast<float>(place % 4) / 4 / kFocal_px,
                  static_cast<float>(place / 4) / 4 / kFocal_px, -1.0f},
                 {0.0f, 0.0f, 1.0f}, kSigma_m, kArea_m2, glm::vec3(1.0f));
    const Moments m = momentsOfRed(render(cloud, squareView(301, kFocal_px), settings));
    mean.mass += m.mass / 16.0;
    mean.variance_x += m.variance_x / 16.0;
    mean.variance_y += m.variance_y / 16.0;
  }
  return mean;
}

TEST(Sweep, PointOfLightHasTheVarianceOfTheFormula) {
  const double unblurred_px2 =
      1.0 + 0.1 * 0.1;  // prefilter and the surfel's own (0.1 mm at 1000 px a m)
  for (double radius_px : {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0}) {
    const Moments m = pointOfLight(blurred(static_cast<float>(radius_px), 0.0f));
    const double expected_px2 = unblurred_px2 + kDiscVariancePerRadius2 * radius_px * radius_px;
    EXPECT_NEAR(m.variance_x / expected_px2, 1.0, kMomentTolerance)
        << "radius " << radius_px << " px";
    EXPECT_NEAR(m.variance_y / expected_px2, 1.0, kMomentTolerance)
        << "radius " << radius_px << " px";
    EXPECT_NEAR(m.mass, 0.04, 0.04 * kEnergyTolerance)
        << "radius " << radius_px << " px";  // 4e-8 m^2
  }
}

TEST(Sweep, OblongPixelsBlurEachAxisByItsOwnRadius) {
  RenderSettings settings = blurred(10.0f, 0.0f);
  settings.defocus.radius_px_per_D.y = 5.0f;
  const Moments m = pointOfLight(settings);
  EXPECT_NEAR(m.variance_x / (1.01 + kDiscVariancePerRadius2 * 100.0), 1.0, kMomentTolerance);
  EXPECT_NEAR(m.variance_y / (1.01 + kDiscVariancePerRadius2 * 25.0), 1.0, kMomentTolerance);
}

TEST(Sweep, DistanceCountsAlongTheSightForTheEyeAndAlongTheAxisForACamera) {
  // A point 45 degrees off axis, focus on its depth: sharp for the camera, blurred for the eye.
  SurfelCloud cloud;
  appendSurfel(cloud, {1.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 1.0f}, 1e-3f, 4e-6f, glm::vec3(1.0f));
  View view = squareView(101, 100.0f);
  view.principal_px.x -= 100.0f;
  RenderSettings settings = blurred(20.0f, 1.0f);
  settings.defocus.along = DistanceAlong::axis;
  EXPECT_LT(momentsOfRed(render(cloud, view, settings)).variance_x, 1.2);
  settings.defocus.along = DistanceAlong::sight;
  const double radius_px = 20.0 * (1.0 - 1.0 / std::sqrt(2.0));
  double variance = 0.0;
  for (int place = 0; place < 16; ++place) {
    View moved = view;
    moved.principal_px += glm::vec2(place % 4, place / 4) / 4.0f;
    variance += momentsOfRed(render(cloud, moved, settings)).variance_y / 16.0;
  }
  EXPECT_NEAR(variance, 1.0 + kDiscVariancePerRadius2 * radius_px * radius_px, 0.3);
}

TEST(Sweep, ConstantSheetStaysConstantAtAnyBlur) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -1.0f, 0.4f, 160, {0.2f, 0.5f, 0.8f});  // a surfel every 1.5 px
  for (float radius_px : {0.0f, 2.0f, 12.0f}) {
    const Frame frame = render(cloud, squareView(96, 600.0f), blurred(radius_px, 0.0f));
    for (int y = 16; y < 80; ++y) {
      for (int x = 16; x < 80; ++x) {
        ASSERT_NEAR(frame.at(x, y).a, 1.0f, 0.02f) << x << "," << y << " radius " << radius_px;
        ASSERT_NEAR(frame.at(x, y).g / frame.at(x, y).a, 0.5f, 1e-5f);
      }
    }
  }
}

TEST(Sweep, EdgeOfABlurredHalfPlaneCoversHalf) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -1.0f, 0.4f, 200, glm::vec3(1.0f), 1.0f,
                 -0.2f);  // its right edge on the axis
  const Frame frame = render(cloud, squareView(120, 600.0f), blurred(10.0f, 0.0f));
  EXPECT_NEAR(0.5f * (frame.at(59, 60).a + frame.at(60, 60).a), 0.5f, 0.01f);
  // By symmetry the coverage right of the edge equals the gap left of it.
  for (int d = 1; d < 25; ++d)
    EXPECT_NEAR(frame.at(60 + d, 60).a, 1.0f - frame.at(59 - d, 60).a, 0.01f);
}

TEST(Sweep, NearSheetHidesTheFarOne) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -2.0f, 1.0f, 250, {0.0f, 1.0f, 0.0f});
  addSquareSheet(cloud, -1.0f, 0.4f, 160, {1.0f, 0.0f, 0.0f});
  const Frame frame = render(cloud, squareView(64, 600.0f), sharp());
  EXPECT_GT(frame.at(32, 32).r, 0.98f);
  EXPECT_LT(frame.at(32, 32).g, 0.02f);
}

TEST(Sweep, RendersNothingBehindAnOpaqueSheet) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -1.0f, 0.4f, 160, {1.0f, 0.0f, 0.0f});
  const View view = squareView(64, 600.0f);
  RenderStats alone, hiding;
  const Frame near_only = render(cloud, view, sharp(), &alone);
  addSquareSheet(cloud, -2.0f, 1.0f, 250, {0.0f, 1.0f, 0.0f});
  const Frame both = render(cloud, view, sharp(), &hiding);
  EXPECT_GT(hiding.splats, 3 * alone.splats / 2);
  EXPECT_EQ(hiding.fragments, alone.fragments);
  for (std::size_t p = 0; p < both.rgba.size(); ++p) {
    ASSERT_NEAR(both.rgba[p].r, 1.0f, 1e-5f);  // of a sheet that covers 0.98 and more
    ASSERT_EQ(both.rgba[p].g, 0.0f);
  }
}

TEST(Sweep, TransparentSheetsCompositeFrontToBack) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -3.0f, 1.5f, 250, {0.0f, 0.0f, 1.0f});
  addSquareSheet(cloud, -1.0f, 0.4f, 160, {1.0f, 0.0f, 0.0f}, 0.5f);
  addSquareSheet(cloud, -2.0f, 1.0f, 250, {0.0f, 1.0f, 0.0f}, 0.25f);
  for (float radius_px : {0.0f, 3.0f}) {
    const Frame frame = render(cloud, squareView(64, 600.0f), blurred(radius_px, 0.0f));
    EXPECT_NEAR(frame.at(32, 32).r, 0.5f, 0.02f);
    EXPECT_NEAR(frame.at(32, 32).g, 0.5f * 0.25f, 0.02f);
    EXPECT_NEAR(frame.at(32, 32).b, 0.5f * 0.75f, 0.02f);
  }
}

// A pane changes nothing in tiles that it does not touch, of glass or opaque: an opaque surface
// there takes no light from behind it. The wall's kernels sum to 1.1, and its colours are random,
// so that the splats beyond the first 1.01 would show.
TEST(Sweep, GlassChangesNothingInOtherTiles) {
  SurfelCloud opaque;
  addSquareSheet(opaque, -3.0f, 1.5f, 250, glm::vec3(1.0f));
  std::mt19937 random(3);
  for (std::size_t i = 0; i < opaque.size(); ++i) {
    opaque.color[i] = glm::vec3(static_cast<float>(random() & 255) / 255.0f);
    opaque.area_m2[i] *= 1.1f;
  }
  SurfelCloud glass = opaque;
  Sheet pane{.center_m = {-0.04f, 0.0f, -1.0f}, .side_m = 0.02f, .samples = 20};
  addSheetOf(opaque, pane);
  pane.opacity = 0.5f;
  addSheetOf(glass, pane);
  for (const float radius_px : {0.0f, 3.0f}) {
    const Frame a = render(opaque, squareView(64, 600.0f), blurred(radius_px, 0.0f));
    const Frame b = render(glass, squareView(64, 600.0f), blurred(radius_px, 0.0f));
    float left = 0.0f, right = 0.0f;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        float& largest = x < 32 ? left : right;
        largest = std::max(largest, glm::distance(a.at(x, y), b.at(x, y)));
      }
    }
    EXPECT_GT(left, 0.1f);
    EXPECT_EQ(right, 0.0f);
  }
}

TEST(Sweep, BackgroundShowsWhereNothingCoversIt) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -1.0f, 0.4f, 160, glm::vec3(1.0f), 0.3f);
  RenderSettings settings = sharp();
  settings.lighting.background = {0.0f, 0.0f, 2.0f};
  const Frame frame = render(cloud, squareView(64, 600.0f), settings);
  EXPECT_NEAR(frame.at(32, 32).r, 0.3f, 0.01f);
  EXPECT_NEAR(frame.at(32, 32).b, 0.3f + 0.7f * 2.0f, 0.02f);
}

TEST(Sweep, FarSideOfASolidStaysHiddenAtItsOutline) {
  // A sphere, red on its front and green on its back. Blurred or not, no green is visible, and the
  // outline covers as much as the front alone.
  SurfelCloud near_side, whole;
  constexpr int kSurfels = 20000;
  constexpr float kRadius_m = 0.2f,
                  kArea_m2 = 4.0f * 3.14159265f * kRadius_m * kRadius_m / kSurfels;
  const glm::vec3 center(0.0f, 0.0f, -1.0f);
  for (int i = 0; i < kSurfels; ++i) {
    const float y = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / kSurfels;
    const float angle = 2.39996323f * static_cast<float>(i), r = std::sqrt(1.0f - y * y);
    const glm::vec3 normal(r * std::cos(angle), y, r * std::sin(angle));
    const glm::vec3 p = center + kRadius_m * normal;
    const bool facing = glm::dot(normal, p) < 0.0f;
    const glm::vec3 color = facing ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
    const float sigma_m = kSigmaPerSpacing * std::sqrt(kArea_m2);
    appendSurfel(whole, p, normal, sigma_m, kArea_m2, color);
    if (facing) appendSurfel(near_side, p, normal, sigma_m, kArea_m2, color);
  }
  whole.oriented = near_side.oriented = true;
  for (float radius_px : {0.0f, 6.0f}) {
    const Frame both = render(whole, squareView(128, 250.0f), blurred(radius_px, 0.0f));
    const Frame one = render(near_side, squareView(128, 250.0f), blurred(radius_px, 0.0f));
    double red = 0.0, green = 0.0, coverage = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < both.rgba.size(); ++i) {
      red += both.rgba[i].r;
      green += both.rgba[i].g;
      coverage += one.rgba[i].a;
      difference += std::abs(both.rgba[i].a - one.rgba[i].a);
    }
    EXPECT_LT(green, kOutlineTolerance * red) << "blur " << radius_px;
    EXPECT_LT(difference, kOutlineTolerance * coverage) << "blur " << radius_px;
  }
}

/// The outlines of two sheets meet on a line through the image, at any angle and place between the
/// pixels. Together they are whole: nothing shows between them.
TEST(Sweep, SheetsWhoseOutlinesMeetShowNothingBetween) {
  for (const float angle : {0.0f, 0.3f, 0.785f, 1.4f}) {
    for (const float shift_px : {0.0f, 0.25f, 0.5f}) {
      const glm::vec3 along(std::cos(angle), std::sin(angle), 0.0f);
      const glm::vec3 across(-along.y, along.x, 0.0f);
      SurfelCloud cloud;
      for (const float side : {-1.0f, 1.0f}) {
        const float z_m = side < 0.0f ? 1.0f : 2.0f, per_px_m = z_m / 600.0f, half_px = 60.0f;
        addSheetOf(cloud, {.center_m = (shift_px + side * half_px) * per_px_m * across -
                                       glm::vec3(0.0f, 0.0f, z_m),
                           .right = along,
                           .up = across,
                           .side_m = 2.0f * half_px * per_px_m,
                           .samples = 120,
                           .color = glm::vec3(0.0f)});
      }
      RenderSettings settings = sharp();
      settings.lighting.background = glm::vec3(1.0f);
      const Frame frame = render(cloud, squareView(64, 600.0f), settings);
      for (int y = 16; y < 48; ++y) {
        for (int x = 16; x < 48; ++x) {
          EXPECT_LT(frame.at(x, y).r, 0.05f) << x << "," << y << " angle " << angle;
        }
      }
    }
  }
}

TEST(Sweep, DepthIsTheDistanceAlongTheSight) {
  SurfelCloud cloud;
  addSquareSheet(cloud, -1.0f, 0.4f, 160, glm::vec3(1.0f));
  RenderSettings settings = sharp();
  settings.depth = true;
  const Frame frame = render(cloud, squareView(65, 600.0f), settings);
  EXPECT_NEAR(frame.depth_m[32 * 65 + 32], 1.0f, 1e-3f);
  const float corner = std::sqrt(1.0f + 2.0f * (32.0f / 600.0f) * (32.0f / 600.0f));
  EXPECT_NEAR(frame.depth_m[0], corner, 1e-3f);
}

TEST(Sweep, EmptySceneIsBackground) {
  RenderSettings settings = sharp();
  settings.lighting.background = {0.1f, 0.2f, 0.3f};
  settings.depth = true;
  RenderStats stats;
  const Frame frame = render(SurfelCloud{}, squareView(33, 100.0f), settings, &stats);
  EXPECT_EQ(stats.splats, 0u);
  EXPECT_EQ(frame.at(32, 32), glm::vec4(0.1f, 0.2f, 0.3f, 0.0f));
  EXPECT_EQ(frame.depth_m[5], 0.0f);
}

TEST(Sweep, DropsSurfelsThatCannotBeRendered) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              inf = std::numeric_limits<float>::infinity();
  SurfelCloud cloud;
  const glm::vec3 up(0.0f, 0.0f, 1.0f), white(1.0f);
  for (const glm::vec3& p : {glm::vec3(nan, 0, -1), glm::vec3(0, inf, -1), glm::vec3(0, 0, -inf),
                             glm::vec3(0, 0, 1), glm::vec3(0, 0, 0), glm::vec3(0, 0, -0.005f)}) {
    appendSurfel(cloud, p, up, 0.01f, 1e-4f, white);
  }
  appendSurfel(cloud, {0, 0, -1}, up, 0.0f, 1e-4f, white);                   // no extent
  appendSurfel(cloud, {0, 0, -1}, up, 0.01f, 0.0f, white);                   // no area
  appendSurfel(cloud, {0, 0, -1}, {1.0f, 0.0f, 0.0f}, 0.01f, 1e-4f, white);  // edge on
  appendSurfel(cloud, {0, 0, -1}, up, nan, 1e-4f, white);
  appendSurfel(cloud, {0, 0, -1}, up, 1e30f, 1e30f, white);
  for (float radius_px : {0.0f, 1e6f, inf}) {
    RenderStats stats;
    const Frame frame = render(cloud, squareView(64, 100.0f), blurred(radius_px, 0.5f), &stats);
    EXPECT_EQ(stats.splats, 0u) << "blur " << radius_px;
    for (const glm::vec4& pixel : frame.rgba) EXPECT_EQ(pixel, glm::vec4(0.0f));
  }
}

TEST(Sweep, BlurWiderThanTheScreenKeepsItsEnergy) {
  // A bright point blurred to a radius of 1000 px over 64 px: nearly flat, at mass / footprint.
  SurfelCloud cloud;
  appendSurfel(cloud, {0, 0, -1}, {0, 0, 1}, 1e-3f, 1e-6f, glm::vec3(1.0f));
  const Frame frame = render(cloud, squareView(64, 1000.0f), blurred(1000.0f, 0.0f));
  const double peak = 1.0 / (std::numbers::pi * 1e6);  // a disc's
  EXPECT_NEAR(frame.at(32, 32).r / peak, 1.0, 0.01);
  EXPECT_NEAR(frame.at(0, 0).r / frame.at(32, 32).r, 1.0, 0.01);
}

TEST(Sweep, SameBytesAtAnyNumberOfThreads) {
  const SurfelCloud cloud = randomCloud(20000, 3);
  const auto bytes = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    RenderSettings settings = blurred(4.0f, 1.0f);
    settings.depth = true;
    return render(cloud, squareView(200, 200.0f), settings);
  };
  const Frame one = bytes(1);
  for (std::size_t threads : {2, 4}) {
    const Frame many = bytes(threads);
    EXPECT_EQ(std::memcmp(one.rgba.data(), many.rgba.data(), one.rgba.size() * sizeof(one.rgba[0])),
              0);
    EXPECT_EQ(one.depth_m, many.depth_m);
  }
}

TEST(Sweep, EverySimdTargetAgreesWithScalar) {
  const SurfelCloud cloud = randomCloud(3000, 4);
  const View view = squareView(150, 150.0f);
  const auto on = [&](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const Frame frame = render(cloud, view, blurred(3.0f, 1.0f));
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return frame;
  };
  const Frame best = on(hwy::SupportedTargets());
  int compared = 0;
  for (std::int64_t target : {HWY_SCALAR, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
    if (!(hwy::SupportedTargets() & target)) continue;
    const Frame frame = on(target);
    ++compared;
    int differ = 0;
    for (std::size_t i = 0; i < best.rgba.size(); ++i) {
      const glm::vec4 delta = glm::abs(best.rgba[i] - frame.rgba[i]);
      differ += std::max({delta.r, delta.g, delta.b, delta.a}) > kSimdTolerance;
    }
    // Where a z-range just touches another, rounding decides whether a layer closes.
    EXPECT_LE(differ, 20) << hwy::TargetName(target);
  }
  EXPECT_GE(compared, 2);
}

TEST(Sweep, OrderOfSurfelsDoesNotMatter) {
  const SurfelCloud cloud = randomCloud(2000, 5);
  SurfelCloud reversed = cloud;
  const auto reverse = [](auto& values) { std::reverse(values.begin(), values.end()); };
  reverse(reversed.position_m);
  reverse(reversed.axis_u_m);
  reverse(reversed.axis_v_m);
  reverse(reversed.color);
  reverse(reversed.opacity);
  reverse(reversed.area_m2);
  const Frame a = render(cloud, squareView(100, 100.0f), sharp());
  const Frame b = render(reversed, squareView(100, 100.0f), sharp());
  int differ = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const glm::vec4 delta = glm::abs(a.rgba[i] - b.rgba[i]);
    differ += std::max({delta.r, delta.g, delta.b}) > kSimdTolerance;
  }
  EXPECT_LE(differ, 5);  // splats whose distances fall on one sorting key
}

TEST(Sweep, ShadingFallsOffWithTheCosine) {
  SurfelCloud cloud;
  appendSurfel(cloud, {0, 0, -1}, glm::normalize(glm::vec3(0.0f, 1.0f, 1.0f)), 0.01f, 1e-4f,
               glm::vec3(1.0f));
  RenderSettings settings = sharp();
  const double plain = momentsOfRed(render(cloud, squareView(64, 300.0f), settings)).mass;
  settings.lighting.shading = 1.0f;
  const double shaded = momentsOfRed(render(cloud, squareView(64, 300.0f), settings)).mass;
  EXPECT_NEAR(shaded / plain, std::sqrt(0.5), 1e-3);
}

TEST(Methods, WrongNamesAndNumbersAreToldWhatWasExpected) {
  EXPECT_EQ(expectedMethod("sweep"), std::nullopt);
  EXPECT_EQ(expectedMethod("accumulate:16"), std::nullopt);
  EXPECT_EQ(expectedMethod("sweap"), "a known method; the nearest is sweep");
  EXPECT_EQ(expectedMethod("pinhole:3"), "pinhole, which takes no number");
  for (const char* spec :
       {"accumulate:", "accumulate:0", "accumulate:-1", "accumulate:1e9", "accumulate:7x"}) {
    EXPECT_EQ(expectedMethod(spec), "accumulate:1 to accumulate:100000") << spec;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
