// The reference against closed forms, and its known failure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kVarianceOfSamples = 0.01;  // of a sunflower of 200 points against the disc's
constexpr double kShareOfSamples = 0.02;     // of half-planes against 200 points, and a pixel

/// Share of the unit disc beyond a line at the signed distance `d` from its centre.
double segment(double d) {
  d = std::clamp(d, -1.0, 1.0);
  return (std::acos(d) - d * std::sqrt(1.0 - d * d)) / std::numbers::pi;
}

float brightest(const Frame& frame) {
  float most = 0.0f;
  for (const glm::vec4& pixel : frame.rgba) most = std::max(most, pixel.r);
  return most;
}

TEST(Accumulate, PointOfLightHasTheVarianceOfTheDisc) {
  const SurfelCloud cloud = pointOfLight({0.0f, 0.0f});
  for (const double radius_px : {2.0, 8.0}) {
    const Moments m = momentsOf(render("accumulate:200", cloud, squareView(41, kPointFocal_px),
                                       lens(static_cast<float>(radius_px), 0.0f)));
    const double expected = kPointVariance_px2 + 0.25 * radius_px * radius_px;
    EXPECT_NEAR(m.mass / kPointMass, 1.0, kVarianceOfSamples);
    EXPECT_NEAR(m.variance_x_px2 / expected, 1.0, kVarianceOfSamples);
    EXPECT_NEAR(m.variance_y_px2 / expected, 1.0, kVarianceOfSamples);
  }
}

TEST(Accumulate, TheBackgroundShowsThroughABlurredEdge) {
  const EdgeScene scene;
  const Frame frame = render("accumulate:200", scene.cloud, scene.view, EdgeScene::farInFocus());
  for (const int right_px : {-7, -4, -1, 1, 4, 7}) {
    // The pixel's centre is half a pixel nearer to the edge.
    const double off_px = right_px - (right_px < 0 ? -0.5 : 0.5);
    const double covered = segment(off_px / EdgeScene::kRadius_px);
    const glm::vec3 color = EdgeScene::at(frame, right_px);
    EXPECT_NEAR(color.r, covered, kShareOfSamples) << right_px;
    EXPECT_NEAR(color.g, 1.0 - covered, kShareOfSamples) << right_px;
  }
}

TEST(Accumulate, FailureFewViewsShowAsGhosts) {
  // A point of light should become a disc of pi 12^2 pixels. 8 views turn it into 8 points.
  const SurfelCloud cloud = pointOfLight({0.0f, 0.0f});
  const View view = squareView(41, kPointFocal_px);
  const float sharp = brightest(render("pinhole", cloud, view, lens(0.0f, 0.0f)));
  const float few = brightest(render("accumulate:8", cloud, view, lens(12.0f, 0.0f)));
  const float many = brightest(render("accumulate:500", cloud, view, lens(12.0f, 0.0f)));
  EXPECT_GT(few, 0.6f * sharp / 8.0f);  // each shifted by parts of a pixel
  EXPECT_LT(many, few / 5.0f);
}

}  // namespace FOCI_FILE
}  // namespace foci
