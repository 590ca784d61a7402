#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/quantile.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/methods/quality_level.h"
#include "render/scene/builtin/procedural.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

Frame greyFrame(float grey) {
  return {.size_px = {16, 16}, .rgba = std::vector<glm::vec4>(256, glm::vec4(grey)), .depth_m = {}};
}

float lightness(float luminance) { return 116.0f * std::cbrt(luminance) - 16.0f; }

TEST(VisibleDifference, OfGreysIsTheDifferenceOfTheirLightness) {
  const auto apart = visibleDifference(greyFrame(0.2f), greyFrame(0.25f), kUsualPx_per_deg);
  const float expected = (lightness(0.25f) - lightness(0.2f)) / 2.3f;
  for (const float each : apart) EXPECT_NEAR(each, expected, 1e-3f);
}

// L*a*b* of the primaries of sRGB under D65, to two digits as in tables.
TEST(VisibleDifference, OfColoursIsTheirDistanceInLab) {
  const glm::vec3 white(100.0f, 0.0f, 0.0f);
  const std::pair<glm::vec3, glm::vec3> primaries[] = {
      {{1.0f, 0.0f, 0.0f}, {53.24f, 80.09f, 67.20f}},
      {{0.0f, 1.0f, 0.0f}, {87.73f, -86.18f, 83.18f}},
      {{0.0f, 0.0f, 1.0f}, {32.30f, 79.19f, -107.86f}}};
  for (const auto& [rgb, lab] : primaries) {
    Frame frame = greyFrame(0.0f);
    for (glm::vec4& each : frame.rgba) each = glm::vec4(rgb, 1.0f);
    const auto apart = visibleDifference(frame, greyFrame(1.0f), kUsualPx_per_deg);
    for (const float each : apart) EXPECT_NEAR(each, glm::distance(lab, white) / 2.3f, 0.02f);
  }
}

// A bright pixel spreads to its neighbours as the Gaussian of the eye, also at the image's edge.
TEST(VisibleDifference, BlursLikeAnEyeInFocus) {
  constexpr double kPx_per_deg = 120.0;  // a standard deviation of one pixel
  Frame spot = greyFrame(0.0f);
  spot.rgba[static_cast<std::size_t>(8) * 16 + 8] = glm::vec4(1.0f);
  const auto apart = visibleDifference(spot, greyFrame(0.0f), kPx_per_deg);
  for (int x = 5; x < 12; ++x) {
    const float dx = static_cast<float>(x - 8);
    const float light = std::exp(-0.5f * dx * dx) / 6.2832f;
    const float expected = light > 0.008856f ? lightness(light) : 903.3f * light;
    EXPECT_NEAR(apart[static_cast<std::size_t>(8) * 16 + static_cast<std::size_t>(x)],
                expected / 2.3f, 0.01f * expected);
  }
  Frame edge = greyFrame(0.0f);
  for (std::size_t y = 0; y < 16; ++y) edge.rgba[y * 16] = glm::vec4(1.0f);
  const auto from_edge = visibleDifference(edge, greyFrame(0.0f), kPx_per_deg);
  EXPECT_NEAR(from_edge[0], lightness(0.6995f) / 2.3f, 0.01f);  // erf share of x < 0.5, replicated
}

TEST(VisibleDifference, LightBeyondWhiteIsWhite) {
  const auto apart = visibleDifference(greyFrame(1.0f), greyFrame(5.0f), kUsualPx_per_deg);
  for (const float each : apart) EXPECT_EQ(each, 0.0f);
}

TEST(VisibleDifference, DetailThatTheEyeCannotResolveCountsLess) {
  Frame stripes = greyFrame(0.0f);
  for (std::size_t i = 0; i < stripes.rgba.size(); ++i) {
    stripes.rgba[i] = glm::vec4(i % 2 == 0 ? 0.1f : 0.3f);
  }
  auto coarse = visibleDifference(stripes, greyFrame(0.2f), 20.0);
  auto fine = visibleDifference(stripes, greyFrame(0.2f), 120.0);
  EXPECT_LT(quantile(fine, 0.5), 0.3f * quantile(coarse, 0.5));
}

class AutoTest : public ::testing::Test {
 protected:
  SurfelCloud cloud = makePlane(160, 1.0f);
  View view = [] {
    View tilted = squareViewOf(128, 190.0f);
    tilted.eye_from_world =
        eyeFromWorld({0.0f, 0.9f, 0.9f}, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f});
    return tilted;
  }();

  static RenderSettings settings(float radius_px_per_D, float tolerance = 1.0f) {
    RenderSettings all = blurredBy(radius_px_per_D, 1.0f / 1.27f);
    all.quality.tolerance = tolerance;
    return all;
  }

  static RenderSettings checked(RenderSettings of, ErrorCheck when) {
    of.quality.check = when;
    return of;
  }

  /// A frame after those that measured the errors.
  static Frame measured(const SurfelCloud& scene, const View& seen, const RenderSettings& of,
                        RenderStats* stats = nullptr) {
    const auto method = makeMethod("auto", scene);
    method->pass(seen, checked(of, ErrorCheck::at_once));
    Frame frame;
    const RenderStats cost = method->render(seen, of, frame);
    if (stats) *stats = cost;
    return frame;
  }

  Frame renderedAt(QualityLevel level, const RenderSettings& of,
                   RenderStats* stats = nullptr) const {
    return renderedBy(textOf(level).c_str(), cloud, view, of, stats);
  }
};

TEST_F(AutoTest, PredictsAnUpperBoundOfTheError) {
  for (const float radius_px_per_D : {2.0f, 20.0f, 60.0f}) {
    const Frame reference = renderedBy("accumulate:128", cloud, view, settings(radius_px_per_D));
    for (int n = 1; n <= static_cast<int>(kQualityLevels); ++n) {
      const QualityLevel level = *qualityLevelNumbered(n);
      RenderStats stats;
      const Frame frame = renderedAt(level, settings(radius_px_per_D), &stats);
      EXPECT_EQ(stats.quality_level, level);
      ASSERT_TRUE(stats.tolerance_error.has_value());
      EXPECT_LE(visibleErrorOf(frame, reference), *stats.tolerance_error)
          << textOf(level) << " " << radius_px_per_D;
    }
  }
}

TEST_F(AutoTest, RendersNoBlurWhereItIsInvisible) {
  const Frame sharp = renderedAt(QualityLevel::sharp, settings(0.0f));
  RenderStats stats;
  const Frame hardly_blurred = measured(cloud, view, settings(3.0f), &stats);
  EXPECT_EQ(hardly_blurred.rgba, sharp.rgba);
  EXPECT_LE(*stats.tolerance_error, 1.0);
  EXPECT_NE(measured(cloud, view, settings(20.0f)).rgba, sharp.rgba);
  EXPECT_NE(measured(cloud, view, settings(3.0f, 0.3f)).rgba, sharp.rgba);
}

TEST_F(AutoTest, ALargerToleranceCostsLess) {
  std::uint64_t before = UINT64_MAX;
  double error = 0.0;
  for (const float tolerance : {0.1f, 100.0f}) {
    RenderStats stats;
    renderedBy("auto", cloud, view, settings(40.0f, tolerance), &stats);
    EXPECT_LT(stats.splats, before) << tolerance;
    EXPECT_GT(*stats.tolerance_error, error) << tolerance;
    before = stats.splats;
    error = *stats.tolerance_error;
  }
}

// On a plane, sub-apertures would change nothing. Where surfaces overlap in much of the view, a
// whole-aperture pass would exceed the tolerance.
TEST_F(AutoTest, RendersSubAperturesWhereSurfacesOverlap) {
  RenderStats stats;
  measured(cloud, view, settings(60.0f), &stats);
  EXPECT_LE(*stats.quality_level, QualityLevel::whole_aperture);

  SurfelCloud crossing;  // stripes in front of stripes, all of them blurred
  for (int k = -4; k <= 4; ++k) {
    const auto x_m = 0.06f * static_cast<float>(k);
    for (int row = -3; row <= 3; ++row) {
      const auto y_m = 0.08f * static_cast<float>(row);
      addSheetOf(crossing, {.center_m = {x_m, y_m, -0.8f},
                            .side_m = 0.03f,
                            .samples = 12,
                            .color = {1.0f, 0.1f, 0.1f}});
      addSheetOf(crossing, {.center_m = {x_m + 0.01f, y_m, -0.9f},
                            .side_m = 0.04f,
                            .samples = 14,
                            .color = {0.1f, 1.0f, 0.1f}});
    }
  }
  const View ahead = squareViewOf(128, 300.0f);
  const RenderSettings blurred = blurredBy(10.0f, 0.0f);
  const Frame apart = measured(crossing, ahead, blurred, &stats);
  const Frame reference = renderedBy("accumulate:256", crossing, ahead, blurred);
  const float error = visibleErrorOf(apart, reference);
  const std::string whole_aperture = textOf(QualityLevel::whole_aperture);
  const float error_of_whole =
      visibleErrorOf(renderedBy(whole_aperture.c_str(), crossing, ahead, blurred), reference);
  EXPECT_GT(error_of_whole, 1.0f);
  EXPECT_LT(error, 0.8f * error_of_whole);
  // The stripes are so small and so near that 7 sub-apertures do not meet the tolerance.
  EXPECT_EQ(*stats.quality_level, QualityLevel::thorough);
  EXPECT_TRUE(stats.tolerance_met);
  EXPECT_LE(error, *stats.tolerance_error);
  // Until that is measured, frames are fine, and say what is known of their error.
  renderedBy("auto", crossing, ahead, blurred, &stats);
  EXPECT_EQ(*stats.quality_level, QualityLevel::fine);
  // No level meets a tolerance of nearly nothing.
  RenderSettings strict = checked(blurred, ErrorCheck::of_still);
  strict.quality.tolerance = 0.01f;
  renderedBy("auto", crossing, ahead, strict, &stats);
  EXPECT_EQ(*stats.quality_level, QualityLevel::thorough);
  EXPECT_EQ(stats.tolerance_met, false);
}

// A still is the first frame of a run, but for its error, which is measured.
TEST_F(AutoTest, AStillIsTheFirstFrameOfARun) {
  RenderStats first, still;
  const Frame frame = renderedBy("auto", cloud, view, settings(20.0f), &first);
  const RenderSettings of_still = checked(settings(20.0f), ErrorCheck::of_still);
  EXPECT_EQ(renderedBy("auto", cloud, view, of_still, &still).rgba, frame.rgba);
  EXPECT_LT(*still.tolerance_error, *first.tolerance_error);
}

// The measurement is spread over frames: each renders a part of it, and the last one decides.
TEST_F(AutoTest, SpreadsTheMeasurementOverFrames) {
  const auto method = makeMethod("auto", cloud);
  RenderStats at_once, stats;
  Frame frame;
  const Frame expected = measured(cloud, view, settings(20.0f), &at_once);
  int frames = 0;
  do {
    stats = method->render(view, settings(20.0f), frame);
    ASSERT_LT(++frames, 1000);
  } while (stats.quality_level == QualityLevel::fine);
  EXPECT_GT(frames, 5);
  EXPECT_EQ(stats.quality_level, at_once.quality_level);
  EXPECT_EQ(stats.tolerance_error, at_once.tolerance_error);
  EXPECT_EQ(frame.rgba, expected.rgba);
}

TEST_F(AutoTest, DoesNotFlickerBetweenLevels) {
  const auto method = makeMethod("auto", cloud);
  Frame frame;
  std::set<QualityLevel> levels;
  // The blur trembles by two per cent around many values. Some of them lie where the level changes.
  for (int step = 0; step < 40; ++step) {
    int changes = 0;
    std::optional<QualityLevel> before;
    for (int i = 0; i < 8; ++i) {
      RenderSettings now =
          settings(4.0f * std::pow(1.07f, static_cast<float>(step)) * (i % 2 == 0 ? 1.02f : 1.0f));
      now.quality.frame_ms = 1e6f;  // a budget without effect: no squares of the frame
      const RenderStats stats = method->render(view, now, frame);
      changes += i > 0 && stats.quality_level != before;
      before = stats.quality_level;
      levels.insert(before.value());
    }
    EXPECT_LE(changes, 1) << step;
  }
  EXPECT_GE(levels.size(), 2u);
}

// The level depends on the frames before: a level is left later than it is entered, and the squares
// are kept for a while.
TEST_F(AutoTest, APassedFrameCountsAsARenderedOne) {
  const auto rendering = makeMethod("auto", cloud);
  int fresh_differs = 0;
  for (int step = 0; step < 16; ++step) {
    const auto asked = [&](int at) {
      RenderSettings now =
          settings(4.0f * std::pow(1.15f, static_cast<float>(at < 8 ? at : 15 - at)));
      if (at % 8 == 4)
        now.quality.check = ErrorCheck::at_once;  // the squares of the others take more frames
      return now;
    };
    Frame frame, after_passing, fresh_frame;
    const RenderStats stats = rendering->render(view, asked(step), frame);
    if (step % 8 != 4 && step % 8 != 5 && step != 15) continue;  // with a check, after it, the last
    const auto passing = makeMethod("auto", cloud), fresh = makeMethod("auto", cloud);
    for (int i = 0; i < step; ++i) passing->pass(view, asked(i));
    const RenderStats passed = passing->render(view, asked(step), after_passing);
    EXPECT_EQ(passed.quality_level, stats.quality_level) << step;
    EXPECT_EQ(passed.tolerance_error, stats.tolerance_error) << step;
    EXPECT_EQ(after_passing.rgba, frame.rgba) << step;
    fresh_differs +=
        fresh->render(view, asked(step), fresh_frame).tolerance_error != stats.tolerance_error;
  }
  EXPECT_GT(fresh_differs, 0);
}

TEST_F(AutoTest, IsSoftUnderAShortBudgetUntilTheViewIsPrepared) {
  const auto method = makeMethod("auto", cloud);
  RenderSettings hurried = settings(40.0f, 0.1f);
  hurried.quality.frame_ms = 1e-6f;
  Frame frame;
  RenderStats stats;
  for (int i = 0; i < 10; ++i) stats = method->render(view, hurried, frame);
  EXPECT_EQ(stats.quality_level, QualityLevel::softest);
  EXPECT_FALSE(stats.full_quality);
  EXPECT_GT(*stats.tolerance_error, hurried.quality.tolerance);
  method->cloneSharingScene()->prepare(view, hurried);
  stats = method->render(view, hurried, frame);
  EXPECT_EQ(stats.quality_level, QualityLevel::post_filtered);
  EXPECT_FALSE(stats.full_quality);
  // The level alone gives the same frame, without preparation.
  const Frame again = renderedAt(QualityLevel::post_filtered, settings(40.0f));
  EXPECT_EQ(frame.rgba, again.rgba);
  // Another view is not prepared.
  View moved = view;
  moved.principal_px.x += 1.0f;
  EXPECT_NE(method->render(moved, hurried, frame).quality_level, QualityLevel::post_filtered);
}

TEST_F(AutoTest, MeetsTheToleranceUnderALongBudget) {
  const auto method = makeMethod("auto", cloud);
  RenderSettings unhurried = settings(40.0f, 0.1f);
  unhurried.quality.frame_ms = std::numeric_limits<float>::infinity();
  Frame frame;
  const RenderStats stats = method->render(view, unhurried, frame);
  EXPECT_TRUE(stats.full_quality);
  RenderStats plain;
  EXPECT_EQ(frame.rgba, renderedBy("auto", cloud, view, settings(40.0f, 0.1f), &plain).rgba);
  EXPECT_EQ(stats.tolerance_error, plain.tolerance_error);
  unhurried.quality.frame_ms = 1e6f;
  const auto other = makeMethod("auto", cloud);
  other->render(view, unhurried, frame);  // has no times yet
  // The table, which speaks for every scene, wants the best level where squares may suffice.
  EXPECT_TRUE(other->render(view, unhurried, frame).full_quality);
}

// All colour channels share one level and the verdict on it.
TEST_F(AutoTest, ColourChannelsAreOfFullQualityTogether) {
  RenderSettings chromatic = settings(40.0f, 0.1f);
  chromatic.colours = {{0.3f, {1, 0, 0}}, {0.0f, {0, 1, 0}}, {-0.9f, {0, 0, 1}}};
  const auto method = makeMethod("auto", cloud);
  Frame frame;
  EXPECT_TRUE(method->render(view, chromatic, frame).full_quality);
  chromatic.quality.frame_ms = 1e-6f;
  RenderStats stats;
  for (int i = 0; i < 10; ++i) stats = method->render(view, chromatic, frame);
  EXPECT_EQ(stats.quality_level, QualityLevel::softest);
  EXPECT_FALSE(stats.full_quality);
}

TEST_F(AutoTest, ACloneRendersTheSame) {
  const auto method = makeMethod("auto", cloud);
  const auto clone = method->cloneSharingScene();
  ASSERT_TRUE(clone);
  Frame ours, its;
  method->render(view, settings(10.0f), ours);
  clone->render(view, settings(10.0f), its);
  EXPECT_EQ(ours.rgba, its.rgba);
}

// Squares are compared anew once the gaze has moved.
TEST_F(AutoTest, TheErrorIsThatOfAnEyeThatLooksThere) {
  const auto method = makeMethod("auto", cloud);
  std::optional<double> before;
  for (const float x_px : {20.0f, 120.0f}) {
    RenderSettings foveated = checked(settings(20.0f), ErrorCheck::at_once);
    foveated.quality.acuity = {.gaze_px = {x_px, 10.0f}, .base_px = 0.5f, .per_px = 0.1f};
    Frame frame;
    RenderStats stats = method->render(view, foveated, frame);
    EXPECT_NE(stats.tolerance_error, before);
    before = stats.tolerance_error;
    renderedBy("auto", cloud, view, foveated, &stats);
    EXPECT_EQ(stats.tolerance_error, before);
  }
}

TEST_F(AutoTest, FoveatedIsTheSameAtTheGazeAndCheaperElsewhere) {
  RenderSettings foveated = settings(4.0f);
  foveated.quality.acuity = {.gaze_px = {64.0f, 64.0f}, .base_px = 0.5f, .per_px = 0.1f};
  RenderStats full, fovea;
  const Frame everywhere = renderedAt(QualityLevel::fine, settings(4.0f), &full);
  const Frame around = renderedAt(QualityLevel::fine, foveated, &fovea);
  EXPECT_LT(fovea.splats, full.splats);
  for (int y = 60; y < 68; ++y) {
    for (int x = 60; x < 68; ++x) {
      EXPECT_LT(glm::length(everywhere.at(x, y) - around.at(x, y)), 0.02f) << x << " " << y;
    }
  }
  // The mean light stays the same: the kernels of coarse nodes sum to one within 4 %.
  const auto mean = [](const Frame& frame) {
    glm::vec4 sum(0.0f);
    for (const glm::vec4& each : frame.rgba) sum += each;
    return sum / static_cast<float>(frame.rgba.size());
  };
  EXPECT_LT(glm::length(mean(everywhere) - mean(around)), 0.02f);
}

}  // namespace FOCI_FILE
}  // namespace foci
