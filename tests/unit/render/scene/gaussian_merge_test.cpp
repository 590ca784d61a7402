// Merged Gaussians against closed forms.
#include "render/scene/gaussian_merge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/image/srgb.h"
#include "render/scene/harmonics.h"
#include "tests/unit/render/gaussian_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-5;

/// Area that `n` Gaussians of the opacity `a` in one place cover, over the area of one of opacity
/// 1: the integral of 1 - (1 - a G)^n, with t = a G, is that of (1 - (1 - t)^n) / t from 0 to a.
double coveredByStack(int n, double a) {
  double sum = 0.0;
  for (int k = 1; k <= n; ++k) sum += (1.0 - std::pow(1.0 - a, k)) / k;
  return sum;
}

GaussianMoments stackOf(int n, float opacity) {
  GaussianCloud cloud;
  addGaussian(cloud, {1.0f, 2.0f, 3.0f}, {0.02f, 0.03f, 0.01f}, opacity, glm::vec3(0.5f));
  cloud.opacity[0] += kMinAlpha;
  GaussianMoments sum = momentsOf(cloud, 0);
  for (int stacked = 1; stacked < n; stacked *= 2) sum = merged(sum, sum);
  return sum;
}

TEST(GaussianMerge, MeanAreaOfASphereAndOfADisc) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  EXPECT_NEAR(meanArea_m2({.xx = 4.0f, .yy = 4.0f, .zz = 4.0f}), 4.0 * kTwoPi, kRounding);
  // A disc across the direction d covers |d z| of its area; the mean over the sphere is a half. |d
  // z| is no polynomial, so 7 directions are not exact.
  constexpr double kOfDirections = 0.04;
  EXPECT_NEAR(meanArea_m2({.xx = 1.0f, .yy = 1.0f}), 0.5 * kTwoPi, kOfDirections * kTwoPi);
}

TEST(GaussianMerge, TwoInOnePlaceCoverTheirClosedForm) {
  for (const float opacity : {0.1f, 0.5f, 0.99f, 1.0f}) {
    const GaussianMoments two = stackOf(2, opacity);
    EXPECT_NEAR(two.opacity, coveredByStack(2, opacity), kRounding) << opacity;
    EXPECT_NEAR(two.covered_m2 / stackOf(1, 1.0f).covered_m2, two.opacity, kRounding) << opacity;
    EXPECT_EQ(two.spread_m2, 0.0);
  }
}

TEST(GaussianMerge, AStackSaturatesAsItsClosedForm) {
  // From 4 on, the products of Gaussians are no Gaussians.
  constexpr double kShare = 0.13;
  for (const int n : {4, 8, 16}) {
    for (const float opacity : {0.05f, 0.3f, 0.7f, 1.0f}) {
      const double expected = coveredByStack(n, opacity);
      EXPECT_NEAR(stackOf(n, opacity).opacity, expected, kShare * expected) << n << " " << opacity;
    }
  }
}

TEST(GaussianMerge, AFlatTopCoversTheAreaThatItStandsFor) {
  for (const float opacity : {0.3f, 1.0f, 1.5f, 3.0f}) {
    // The integral of min(1, peak G) over the plane, by rings of equal area.
    const double peak = peakOf(opacity);
    double sum = 0.0;
    constexpr double kStep = 1e-4;
    for (double u = 0.5 * kStep; u < 40.0; u += kStep) {
      sum += kStep * std::min(1.0, peak * std::exp(-u));
    }
    EXPECT_NEAR(sum, opacity, 1e-4 * opacity);
  }
}

TEST(GaussianMerge, FarApartBothAreasAreCovered) {
  GaussianCloud cloud;
  addGaussian(cloud, {-1.0f, 0.3f, 0.1f}, glm::vec3(0.02f), 0.8f, glm::vec3(0.5f));
  addGaussian(cloud, {1.0f, 0.0f, 0.0f}, glm::vec3(0.03f), 0.6f, glm::vec3(0.5f));
  const GaussianMoments a = momentsOf(cloud, 0), b = momentsOf(cloud, 1), both = merged(a, b);
  // Only from one direction of seven do they hide each other.
  EXPECT_NEAR(both.covered_m2, a.covered_m2 + b.covered_m2, 1e-6 * both.covered_m2);
  EXPECT_LT(both.opacity, 0.05);
}

TEST(GaussianMerge, OverlapOfTwoGaussiansIsTheMeanOverDirections) {
  // Two of standard deviation s at the distance D: alpha^2 pi s^2 exp(-(D sin t)^2 / (4 s^2)).
  constexpr float kSigma_m = 0.1f, kApart_m = 0.12f, kOpacity = 0.9f;
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, 0.0f, 0.0f}, glm::vec3(kSigma_m), kOpacity, glm::vec3(0.5f));
  addGaussian(cloud, kApart_m * glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f)), glm::vec3(kSigma_m),
              kOpacity, glm::vec3(0.5f));
  for (float& opacity : cloud.opacity) opacity += kMinAlpha;
  constexpr double s2 = double{kSigma_m} * double{kSigma_m};
  double overlap = 0.0;
  constexpr int kSteps = 10'000;
  for (int k = 0; k < kSteps; ++k) {
    const double cosine = (k + 0.5) / kSteps;
    const double across2 = double{kApart_m} * double{kApart_m} * (1.0 - cosine * cosine);
    overlap += std::exp(-across2 / (4.0 * s2)) / kSteps;
  }
  overlap *= double{kOpacity} * double{kOpacity} * std::numbers::pi * s2;
  const double alone = 2.0 * std::numbers::pi * double{kOpacity} * s2;
  const double expected = 2.0 * alone - overlap;
  EXPECT_NEAR(merged(momentsOf(cloud, 0), momentsOf(cloud, 1)).covered_m2, expected,
              1e-3 * expected);
}

TEST(GaussianMerge, PositionAndCovarianceAreThoseOfTheMixture) {
  GaussianCloud cloud;
  addGaussian(cloud, {-0.2f, 0.0f, 0.1f}, {0.05f, 0.02f, 0.04f}, 0.4f, glm::vec3(0.2f));
  addGaussian(cloud, {0.1f, 0.05f, -0.1f}, {0.01f, 0.06f, 0.03f}, 0.9f, glm::vec3(0.8f),
              glm::normalize(glm::vec4(0.3f, -0.2f, 0.5f, 1.0f)));
  const GaussianMoments a = momentsOf(cloud, 0), b = momentsOf(cloud, 1), both = merged(a, b);
  const double w = a.covered_m2 / (a.covered_m2 + b.covered_m2);
  const glm::dvec3 mean = w * a.mean_m + (1.0 - w) * b.mean_m;
  EXPECT_NEAR(glm::distance(both.mean_m, mean), 0.0, kRounding);
  const auto second = [&](const GaussianMoments& m, int i, int k, float v) {
    return double{v} + m.mean_m[i] * m.mean_m[k];
  };
  EXPECT_NEAR(both.covariance_m2.xy,
              w * second(a, 0, 1, a.covariance_m2.xy) +
                  (1.0 - w) * second(b, 0, 1, b.covariance_m2.xy) - mean.x * mean.y,
              kRounding);
  EXPECT_NEAR(both.covariance_m2.zz,
              w * second(a, 2, 2, a.covariance_m2.zz) +
                  (1.0 - w) * second(b, 2, 2, b.covariance_m2.zz) - mean.z * mean.z,
              kRounding);
  EXPECT_GE(both.radius_m, glm::distance(both.mean_m, b.mean_m) + 3.0 * 0.06);
}

/// A dark and a light Gaussian of harmonics, in one place.
GaussianCloud darkAndLight(float opacity) {
  GaussianCloud cloud;
  for (const float display : {0.2f, 0.8f}) {
    addGaussian(cloud, glm::vec3(0.0f), glm::vec3(0.1f), opacity,
                glm::vec3(display, 0.5f, display));
  }
  cloud.degree = 3;
  cloud.harmonics.resize(2 * cloud.harmonicsPerGaussian());
  for (std::size_t k = 0; k < cloud.harmonics.size(); ++k) {
    cloud.harmonics[k] = static_cast<std::int16_t>(static_cast<int>(k * 37 % 21) - 10);
  }
  return cloud;
}

TEST(GaussianMerge, ColoursMixInEveryDirection) {
  for (const float opacity : {0.1f, 1.0f}) {
    const GaussianCloud cloud = darkAndLight(opacity);
    GaussianCloud node = cloud;
    store(merged(momentsOf(cloud, 0), momentsOf(cloud, 1)), node, 0);
    // Alone, each covers o of its area; both cover 2 o - o^2 / 2. The opaque share o shows them
    // side by side, where they do not overlap.
    const float o = opacity - kMinAlpha, apart = o * (1.0f - o / 4.0f);
    for (const glm::vec3 towards : {glm::vec3(0.0f, 0.0f, 1.0f), glm::vec3(1.0f, -2.0f, 0.5f)}) {
      const glm::vec3 d = glm::normalize(towards);
      const glm::vec3 a = colorOf(cloud, 0, d), b = colorOf(cloud, 1, d), c = colorOf(node, 0, d);
      for (int channel = 0; channel < 3; ++channel) {
        const float light = 0.5f * (linearFromSrgb(a[channel]) + linearFromSrgb(b[channel]));
        const float blended = 0.5f * (a[channel] + b[channel]);
        // Harmonics of a few hundredths, to first order.
        EXPECT_NEAR(c[channel], glm::mix(blended, srgbFromLinear(light), apart), 1e-3f) << channel;
      }
    }
  }
}

TEST(GaussianMerge, SmallGaussiansFarApartBlendByTheirOpacity) {
  // The low-pass of a pixel as wide as their distance makes each of them fill it.
  GaussianCloud cloud;
  addGaussian(cloud, glm::vec3(0.0f), glm::vec3(1e-3f), 0.9f + kMinAlpha, glm::vec3(0.2f));
  addGaussian(cloud, glm::vec3(1.0f, 0.0f, 0.0f), glm::vec3(4e-3f), 0.3f + kMinAlpha,
              glm::vec3(0.8f));
  GaussianCloud node = cloud;
  store(merged(momentsOf(cloud, 0), momentsOf(cloud, 1)), node, 0);
  EXPECT_NEAR(node.color[0].r, (0.9f * 0.2f + 0.3f * 0.8f) / 1.2f, 1e-4f);
}

TEST(GaussianMerge, ALowPassKeepsASingleGaussianAndAddsFaintAreas) {
  for (const float opacity : {0.01f, 0.3f, 1.0f}) {
    EXPECT_NEAR(opacityAfterLowPass(opacity, 100.0f, 0.01f), opacity, kRounding);
  }
  // Eight points of alpha 0.004 above its limit, each widened to 50 times its area, within one of
  // 1000 times its area.
  constexpr float kAlpha = 0.004f, kShare = 8.0f / 1000.0f;
  EXPECT_NEAR(opacityAfterLowPass(kMinAlpha + kAlpha * kShare, 50.0f, 1.0f) - kMinAlpha,
              50.0f * kAlpha * kShare, 1e-5f);
}

}  // namespace FOCI_FILE
}  // namespace foci
