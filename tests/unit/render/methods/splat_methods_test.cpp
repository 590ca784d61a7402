// The strength and the known failure of each other method that renders splats.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kVarianceTolerance = 0.02;  // sampling at pixel centres, mean of 16 places
constexpr double kMassTolerance = 0.01;      // likewise

/// A sheet that fills the image and faces the eye, 1 m away, with a surfel every `spacing_px`.
SurfelCloud whiteSheet(float spacing_px) {
  SurfelCloud cloud;
  addSheet(cloud, 1.0f, 0.5f, static_cast<int>(150.0f / spacing_px), glm::vec3(1.0f));
  return cloud;
}
const View kSheetView = squareView(96, 300.0f);

struct Statistics {
  double mean = 0.0, deviation = 0.0;
};

/// Mean and variance of the coverage in the middle of the image.
Statistics coverageOf(const Frame& frame) {
  double sum = 0.0, squares = 0.0;
  int n = 0;
  for (int y = 24; y < 72; ++y) {
    for (int x = 24; x < 72; ++x, ++n) {
      sum += frame.at(x, y).a;
      squares += frame.at(x, y).a * frame.at(x, y).a;
    }
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

/// Coverage of a blurred half-plane: the share of the unit disc up to `x` from its centre.
double coverageOfDisc(double x) {
  if (std::abs(x) >= 1.0) return x > 0.0 ? 1.0 : 0.0;
  return 0.5 + (x * std::sqrt(1.0 - x * x) + std::asin(x)) / std::numbers::pi;
}

TEST(Layered, TheBackgroundShowsThroughABlurredEdge) {
  const EdgeScene scene;
  constexpr double kTolerance = 0.03;  // the edge's own softness, and the disc on whole pixels
  const Frame far = render("layered", scene.cloud, scene.view, EdgeScene::farInFocus());
  for (int right_px : {-12, -8, -6, -4, -2, 2, 4, 6, 8, 12}) {
    const double middle_px = right_px + (right_px < 0 ? 0.5 : -0.5);
    const double red = coverageOfDisc(-middle_px / EdgeScene::kRadius_px);
    EXPECT_NEAR(EdgeScene::at(far, right_px).r, red, kTolerance) << right_px;
    EXPECT_NEAR(EdgeScene::at(far, right_px).g, 1.0 - red, kTolerance) << right_px;
  }
  // Nothing leaks over the near sheet where it is sharp.
  const Frame near = render("layered", scene.cloud, scene.view, EdgeScene::nearInFocus());
  EXPECT_LT(EdgeScene::at(near, -4).g, 0.02f);
  EXPECT_GT(EdgeScene::at(near, 4).g, 0.98f);
}

TEST(Layered, FailureASurfaceAcrossSeveralLayersComesApart) {
  // A floor from 1 to 3 m. It has no holes where no layer ends.
  SurfelCloud floor;
  constexpr float kStep_m = 0.003f;
  for (int z = 0; z < 700; ++z) {
    for (int x = -60; x < 60; ++x) {
      appendSurfel(
          floor, {static_cast<float>(x) * kStep_m, -0.2f, -1.0f - kStep_m * static_cast<float>(z)},
          {0.0f, 1.0f, 0.0f}, kSigmaPerSpacing * kStep_m, kStep_m * kStep_m, glm::vec3(1.0f));
    }
  }
  const View view = squareView(128, 300.0f);
  const auto leastCoverage = [&](std::string_view method) {
    const Frame frame = render(method, floor, view, lens(12.0f, 1.0f));
    float least = 1.0f;
    for (int y = 98; y < 120; ++y) least = std::min(least, frame.at(64, y).a);
    return least;
  };
  EXPECT_GT(leastCoverage("sweep"), 0.97f);
  EXPECT_LT(leastCoverage("layered:8"), 0.9f);
}

TEST(Rasanen, PointOfLightHasTheVarianceOfTheDisc) {
  for (float radius_px : {0.0f, 2.0f, 10.0f, 40.0f}) {
    const Moments m = momentsOfPoint("rasanen:65536", radius_px);
    // Samples are rounded to full pixels, which adds 1/12.
    const double expected_px2 = kPointVariance_px2 + radius_px * radius_px / 4.0 + 1.0 / 12.0;
    EXPECT_NEAR(m.mass, kPointMass, kPointMass * kMassTolerance) << radius_px;
    EXPECT_NEAR(m.variance_x_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
    EXPECT_NEAR(m.variance_y_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
  }
}

TEST(Rasanen, NothingLeaksWithManySamples) {
  const EdgeScene scene;
  constexpr double kTolerance = 0.05;  // what 1024 samples leave of the noise
  const Frame far = render("rasanen:1024", scene.cloud, scene.view, EdgeScene::farInFocus());
  for (int right_px : {-12, -8, -4, 4, 8, 12}) {
    const double middle_px = right_px + (right_px < 0 ? 0.5 : -0.5);
    const double red = coverageOfDisc(-middle_px / EdgeScene::kRadius_px);
    EXPECT_NEAR(EdgeScene::at(far, right_px).r, red, kTolerance) << right_px;
    EXPECT_NEAR(EdgeScene::at(far, right_px).g, 1.0 - red, kTolerance) << right_px;
  }
}

TEST(Rasanen, FailureNoiseFallsWithTheRootOfTheSamplesOnly) {
  // So dim that no pixel becomes opaque: the weights of the sheet sum to a quarter.
  SurfelCloud cloud = whiteSheet(1.0f);
  for (float& area_m2 : cloud.area_m2) area_m2 *= 0.25f;
  const auto noise = [&](int samples) {
    return coverageOf(
               render("rasanen:" + std::to_string(samples), cloud, kSheetView, lens(4.0f, 0.0f)))
        .deviation;
  };
  EXPECT_NEAR(noise(16) / noise(64), 2.0, 0.2);
  EXPECT_NEAR(noise(64) / noise(256), 2.0, 0.2);
  // A closed sheet has holes.
  const Statistics sheet =
      coverageOf(render("rasanen:4", whiteSheet(1.0f), kSheetView, lens(4.0f, 0.0f)));
  EXPECT_LT(sheet.mean, 0.9);
  EXPECT_GT(sheet.deviation, 0.1);
}

TEST(Inflate, ASplatKeepsItsLightAndHasTheVarianceOfTheGaussian) {
  // A Gaussian of peak 1 and 4 px, truncated at 8 squared standard deviations.
  constexpr double kSigma_px = 4.0, kEnd2 = 8.0;
  const double cut = std::exp(-kEnd2 / 2.0);
  const double mass = 2.0 * std::numbers::pi * kSigma_px * kSigma_px * (1.0 - cut);
  const double kept = (1.0 - cut * (1.0 + kEnd2 / 2.0)) / (1.0 - cut);
  SurfelCloud cloud;
  appendSurfel(cloud, {0.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 1.0f}, 0.004f, 1e-6f, glm::vec3(1.0f));
  for (float radius_px : {0.0f, 5.0f, 10.0f}) {
    const Frame frame =
        render("inflate", cloud, squareView(129, kPointFocal_px), lens(radius_px, 0.0f));
    const Moments m = momentsOf(frame);
    const double blur_px2 = kGaussianVariancePerRadius2 * radius_px * radius_px;
    const double expected_px2 = kept * (kSigma_px * kSigma_px + 1.0 + blur_px2);
    EXPECT_NEAR(m.mass / mass, 1.0, kMassTolerance) << radius_px;
    EXPECT_NEAR(m.variance_x_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
    EXPECT_NEAR(m.variance_y_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
  }
}

TEST(Inflate, FailureBlurredSheetsTransmitLightFromBehind) {
  for (float radius_px : {0.0f, 3.0f, 10.0f}) {
    const Statistics sheet =
        coverageOf(render("inflate", whiteSheet(1.0f), kSheetView, lens(radius_px, 0.0f)));
    // 1 - exp(-2 pi s^2), with a standard deviation of s = 0.62 spacings.
    const double expected =
        1.0 - std::exp(-2.0 * std::numbers::pi * kSigmaPerSpacing * kSigmaPerSpacing);
    EXPECT_NEAR(sheet.mean, expected, 0.02) << radius_px;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
