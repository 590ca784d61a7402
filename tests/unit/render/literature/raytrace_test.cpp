// The two references share no code beyond the kernel's formula. If they agree within their noise,
// lens, layers and kernels are right in both.
#ifdef FOCI_RAYTRACE
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "render/image/metrics.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/scene/builtin/pattern.h"

namespace foci {
namespace FOCI_FILE {

// The mean of two halves has half the error of their difference. In both references the halves are
// stratified against each other, so this estimate is above the error.
constexpr double kNoisePerSplitHalf = 0.5;
// Covers rounding, the order of splats with the same sorting key, and layers that receive less than
// 1 / 8192 of the light.
constexpr double kSharpRms = 2e-4;
View squareView(int size_px, float focal_px) {
  return {.size_px = {size_px, size_px},
          .focal_px = glm::vec2(focal_px),
          .principal_px = glm::vec2(0.5f * static_cast<float>(size_px))};
}

RenderSettings lens(float radius_px_per_D, float focus_D,
                    DistanceAlong along = DistanceAlong::sight) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D),
                      .focus_D = focus_D,
                      .along = along},
          .lighting = {.background = {0.1f, 0.2f, 0.3f}}};
}

/// A chequered square of n x n surfels around `center`. The two directions are half as long as its
/// sides.
void addSquare(SurfelCloud& cloud, const glm::vec3& center, const glm::vec3& half_u,
               const glm::vec3& half_v, int n, const glm::vec3& color, float opacity = 1.0f) {
  const float side_m = 2.0f * glm::length(half_u) / static_cast<float>(n);
  const glm::vec3 normal = glm::normalize(glm::cross(half_u, half_v));
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const glm::vec2 at = (2.0f * glm::vec2(x, y) + 1.0f) / static_cast<float>(n) - 1.0f;
      appendSurfel(cloud, center + at.x * half_u + at.y * half_v, normal, kSigmaPerSpacing * side_m,
                   side_m * side_m, color * (0.3f + 0.7f * checker(8.0f * at)), opacity);
    }
  }
}

struct Rendered {
  Frame frame;
  RenderStats stats;
};

Rendered render(const char* spec, const SurfelCloud& cloud, const View& view,
                const RenderSettings& settings) {
  Rendered out;
  out.stats = makeMethod(spec, cloud)->render(view, settings, out.frame);
  return out;
}

double rmsOf(double psnr_dB) { return std::pow(10.0, -psnr_dB / 20.0); }

/// The references differ by no more than their noise. A lens a tenth wider differs by more.
void expectAgreement(const SurfelCloud& cloud, const View& view, const RenderSettings& settings) {
  const Rendered a = render("accumulate:256", cloud, view, settings);
  const Rendered r = render("raytrace:64", cloud, view, settings);
  const double noise = kNoisePerSplitHalf * std::hypot(rmsOf(*a.stats.split_half_psnr_dB),
                                                       rmsOf(*r.stats.split_half_psnr_dB));
  EXPECT_LT(rmsOf(psnr_dB(a.frame, r.frame)), noise);
  RenderSettings wrong = settings;
  wrong.defocus.radius_px_per_D *= 1.1f;
  EXPECT_GT(rmsOf(psnr_dB(a.frame, render("raytrace:64", cloud, view, wrong).frame)), noise);
}

/// Either the foreground or the background is out of focus.
TEST(Raytrace, AgreesWithAccumulateOnAForegroundOverABackground) {
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, 0.0f, -2.0f}, {0.5f, 0.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, 100,
            {0.2f, 0.9f, 0.4f});
  addSquare(cloud, {0.1f, 0.0f, -1.0f}, {0.1f, 0.0f, 0.0f}, {0.0f, 0.1f, 0.0f}, 40,
            {0.9f, 0.3f, 0.1f});
  for (const float focus_D : {0.5f, 1.0f}) {
    expectAgreement(cloud, squareView(36, 150.0f), lens(8.0f, focus_D));
  }
}

/// The plane is seen at a grazing angle, and the blur changes along it.
TEST(Raytrace, AgreesWithAccumulateOnATiltedPlaneForEyeAndCamera) {
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, -0.15f, -2.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, 128,
            {0.9f, 0.8f, 0.6f});
  for (const DistanceAlong along : {DistanceAlong::sight, DistanceAlong::axis}) {
    expectAgreement(cloud, squareView(36, 60.0f), lens(6.0f, 0.6f, along));
  }
}

TEST(Raytrace, AgreesWithAccumulateThroughTransparentSheets) {
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, 0.0f, -3.0f}, {0.6f, 0.0f, 0.0f}, {0.0f, 0.6f, 0.0f}, 100,
            {0.2f, 0.4f, 0.9f});
  addSquare(cloud, {0.0f, 0.1f, -2.0f}, {0.3f, 0.0f, 0.1f}, {0.0f, 0.3f, 0.0f}, 60,
            {0.9f, 0.8f, 0.2f}, 0.4f);
  addSquare(cloud, {0.0f, 0.0f, -1.0f}, {0.1f, 0.0f, 0.0f}, {0.0f, 0.1f, 0.0f}, 40,
            {0.9f, 0.3f, 0.1f}, 0.5f);
  expectAgreement(cloud, squareView(36, 150.0f), lens(8.0f, 0.5f));
}

/// A pinhole has no noise. This compares the discs and the rays through them with the sweep, at any
/// angle, size and opacity, from both sides.
TEST(Raytrace, AgreesWithTheSweepThroughAPinhole) {
  std::mt19937 random(7);
  const auto uniform = [&](float a, float b) {
    return a + (b - a) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  SurfelCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    const float z_m = uniform(0.5f, 4.0f), sigma_m = uniform(0.0005f, 0.03f);
    const glm::vec3 normal =
        glm::normalize(glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
    appendSurfel(cloud, {uniform(-0.6f, 0.6f) * z_m, uniform(-0.6f, 0.6f) * z_m, -z_m}, normal,
                 sigma_m, 4.0f * sigma_m * sigma_m, {uniform(0, 1), uniform(0, 1), uniform(0, 1)},
                 uniform(0.2f, 1.0f));
  }
  for (const bool oriented : {false, true}) {
    cloud.oriented = oriented;
    RenderSettings settings = lens(0.0f, 1.0f);
    settings.depth = true;
    settings.lighting.shading = 0.5f;
    const View view = squareView(120, 120.0f);
    const Rendered swept = render("sweep", cloud, view, settings);
    const Rendered traced = render("raytrace:4", cloud, view, settings);
    EXPECT_LT(rmsOf(psnr_dB(swept.frame, traced.frame)), kSharpRms);
    EXPECT_LT(coverageError(swept.frame, traced.frame), kSharpRms);
    double depth = 0.0;
    for (std::size_t i = 0; i < swept.frame.depth_m.size(); ++i) {
      depth += std::abs(swept.frame.depth_m[i] - traced.frame.depth_m[i]);
    }
    EXPECT_LT(depth / static_cast<double>(swept.frame.depth_m.size()), kSharpRms);
    EXPECT_EQ(traced.stats.split_half_psnr_dB, std::numeric_limits<double>::infinity());
  }
}

TEST(Raytrace, MoreRaysHaveLessNoise) {
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, 0.0f, -1.0f}, {0.3f, 0.0f, 0.0f}, {0.0f, 0.3f, 0.0f}, 60,
            glm::vec3(1.0f));
  const RenderSettings settings = lens(6.0f, 2.0f);
  const auto noise = [&](const char* spec) {
    return rmsOf(*render(spec, cloud, squareView(32, 50.0f), settings).stats.split_half_psnr_dB);
  };
  EXPECT_LT(noise("raytrace:64"), 0.5 * noise("raytrace:16"));  // at least as random samples do
  EXPECT_FALSE(
      render("raytrace:1", cloud, squareView(8, 50.0f), settings).stats.split_half_psnr_dB);
}

TEST(Raytrace, FailureFewRaysAreNoise) {
  // In a strongly blurred image, neighbouring pixels hardly differ. With few rays they differ
  // randomly.
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, 0.0f, -1.0f}, {0.6f, 0.0f, 0.0f}, {0.0f, 0.6f, 0.0f}, 100,
            glm::vec3(1.0f));
  const auto roughness = [&](const char* spec) {
    const Frame frame = render(spec, cloud, squareView(32, 50.0f), lens(8.0f, 2.0f)).frame;
    double sum = 0.0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 1; x < 32; ++x) sum += std::abs(frame.at(x, y).g - frame.at(x - 1, y).g);
    }
    return sum;
  };
  EXPECT_GT(roughness("raytrace:4"), 4.0 * roughness("accumulate:256"));
}

TEST(Raytrace, SameBytesAtAnyNumberOfThreads) {
  SurfelCloud cloud;
  addSquare(cloud, {0.0f, 0.0f, -1.0f}, {0.3f, 0.0f, 0.2f}, {0.0f, 0.3f, 0.1f}, 60, glm::vec3(1.0f),
            0.7f);
  const auto bytes = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return render("raytrace:5", cloud, squareView(40, 60.0f), lens(6.0f, 2.0f)).frame;
  };
  const Frame one = bytes(1), four = bytes(4);
  EXPECT_EQ(std::memcmp(one.rgba.data(), four.rgba.data(), one.rgba.size() * sizeof(one.rgba[0])),
            0);
}

TEST(Raytrace, InvalidSurfelsAreBackground) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              inf = std::numeric_limits<float>::infinity();
  SurfelCloud cloud;
  const glm::vec3 up(0.0f, 0.0f, 1.0f), white(1.0f);
  for (const glm::vec3& p : {glm::vec3(nan, 0, -1), glm::vec3(0, inf, -1), glm::vec3(0, 0, -inf),
                             glm::vec3(0, 0, 1), glm::vec3(0, 0, 0), glm::vec3(0, 0, -0.005f)}) {
    appendSurfel(cloud, p, up, 0.01f, 1e-4f, white);
  }
  appendSurfel(cloud, {0, 0, -1}, up, 0.0f, 1e-4f, white);  // no extent
  appendSurfel(cloud, {0, 0, -1}, up, 0.01f, 0.0f, white);  // no area
  appendSurfel(cloud, {0, 0, -1}, up, nan, 1e-4f, white);
  appendSurfel(cloud, {0, 0, -1}, up, 1e30f, 1e30f, white);
  for (const SurfelCloud& scene : {SurfelCloud{}, cloud}) {
    for (const float radius_px_per_D : {0.0f, 5.0f, inf}) {
      const Rendered out =
          render("raytrace:3", scene, squareView(16, 50.0f), lens(radius_px_per_D, 0.5f));
      for (const glm::vec4& pixel : out.frame.rgba) {
        EXPECT_EQ(pixel, glm::vec4(0.1f, 0.2f, 0.3f, 0.0f)) << radius_px_per_D;
      }
    }
  }
}

/// Uniform over the disc: E[r^2] = 1/2 and E[r^4] = 1/3, for all samples and for either parity.
TEST(LensSampleOfPixel, IsUnbiasedAtAnyNumber) {
  constexpr int kShifts = 256;
  for (const int n : {1, 2, 3, 7, 16}) {
    for (const int parity : {0, 1}) {
      double r2 = 0.0, r4 = 0.0;
      int count = 0;
      for (int s = 0; s < kShifts; ++s) {
        for (int i = parity; i < n; i += 2, ++count) {
          const glm::dvec2 p(
              lensSampleOfPixel(i, n, (static_cast<float>(s) + 0.5f) / kShifts, 0.3f));
          r2 += glm::dot(p, p);
          r4 += glm::dot(p, p) * glm::dot(p, p);
        }
      }
      if (count == 0) continue;
      EXPECT_NEAR(r2 / count, 0.5, 1e-5) << n;        // float samples
      EXPECT_NEAR(r4 / count, 1.0 / 3.0, 1e-5) << n;  // likewise
    }
  }
}

TEST(LensSampleOfPixel, IsStratifiedInArea) {
  for (const int n : {8, 33}) {
    std::vector<double> area;
    for (int i = 0; i < n; ++i) {
      const glm::dvec2 p(lensSampleOfPixel(i, n, 0.7f, 0.1f));
      area.push_back(glm::dot(p, p));
    }
    std::sort(area.begin(), area.end());
    // The even samples have one in every 2 / n of the area. So have the odd ones, half a step
    // later.
    for (int i = 0; i < n; ++i) EXPECT_NEAR(area[i], (i + 0.5) / n, 1.0 / n) << n;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
#endif
