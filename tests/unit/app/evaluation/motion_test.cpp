#include "app/evaluation/chart/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/evaluation/excess_change.h"
#include "render/methods/method.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-6;  // of floats near 1
constexpr double kLabRounding = 1e-4;

FrameInLab grey(float light) {
  Frame frame;
  frame.resize({50, 40});
  frame.rgba.assign(frame.rgba.size(), glm::vec4(light, light, light, 1.0f));
  return FrameInLab(std::move(frame));
}

/// The same, brighter in red in the first pixels.
FrameInLab brighter(const FrameInLab& of, std::size_t pixels, float by) {
  Frame frame = of.frame;
  for (std::size_t i = 0; i < pixels; ++i) frame.rgba[i].r += by;
  return FrameInLab(std::move(frame));
}

TEST(ExcessChange, IsNoneWhereTheReferenceChangesAsMuch) {
  const FrameInLab dark = grey(0.2f), light = grey(0.7f);
  EXPECT_EQ(excessChange(dark, light, dark, light).light, 0.0);
  EXPECT_EQ(excessChange(dark, light, dark, light).jnd, 0.0);
  // An error that stays is no change.
  const FrameInLab off = brighter(dark, 2000, 0.1f), off_too = brighter(light, 2000, 0.1f);
  EXPECT_NEAR(excessChange(off, off_too, dark, light).light, 0.0, kRounding);
}

TEST(ExcessChange, FindsAKnownExcessOfMoreThanAThousandthOfThePixels) {
  const FrameInLab still = grey(0.3f);
  EXPECT_NEAR(excessChange(still, brighter(still, 4, 0.1f), still, still).light, 0.1, kRounding);
  EXPECT_EQ(excessChange(still, brighter(still, 1, 0.1f), still, still).light, 0.0);
  // Less change than the reference's is an excess too: the frame lags behind.
  EXPECT_NEAR(excessChange(still, still, still, grey(0.5f)).light, 0.2, kRounding);
}

// L* = 116 cbrt(Y) - 16, and 2.3 make a just-noticeable difference.
TEST(ExcessChange, CountsJustNoticeableDifferences) {
  const double expected = 116.0 * (std::cbrt(0.5) - std::cbrt(0.4)) / 2.3;
  EXPECT_NEAR(excessChange(grey(0.4f), grey(0.5f), grey(0.4f), grey(0.4f)).jnd, expected,
              kLabRounding);
}

glm::dvec3 eyeOf(const View& view) {
  return glm::dvec3(glm::inverse(glm::dmat4(view.eye_from_world))[3]);
}

TEST(MotionSteps, MoveTheHeadAsFarAsTheirNamesSay) {
  const SceneInView plane = planeInView(24, 32);
  for (const auto& [path, step_m] :
       {std::pair("head-1mm", 0.001), {"head-10mm", 0.01}, {"head-forwards", 0.005}}) {
    const auto steps = motionSteps(path, plane);
    ASSERT_EQ(steps.size(), 48u);
    for (std::size_t k = 1; k < steps.size(); ++k) {
      EXPECT_NEAR(glm::distance(eyeOf(steps[k].views[0]), eyeOf(steps[k - 1].views[0])), step_m,
                  kRounding)
          << path << " " << k;
    }
  }
  const auto fast = motionSteps("head-10mm", plane);
  for (const MotionStep& step : motionSteps("stereo", plane)) {
    ASSERT_EQ(step.views.size(), 2u);
    EXPECT_NEAR(glm::distance(eyeOf(step.views[0]), eyeOf(step.views[1])), 0.06, kRounding);
    for (const View& view : step.views) {  // the references of the path before serve again
      EXPECT_TRUE(std::ranges::any_of(
          fast, [&](const MotionStep& other) { return other.views[0] == view; }));
    }
  }
}

TEST(MotionSteps, MoveFocusPupilAndGaze) {
  const SceneInView plane = planeInView(24, 32);
  const auto focus = motionSteps("focus", plane);
  const double from_D = focus[0].focus_D, to_D = focus[0].rest_D;
  EXPECT_GT(std::abs(to_D - from_D), 0.01);
  for (std::size_t k = 0; k < focus.size(); ++k) {  // a time constant of 0.2 s (eye-model.md)
    EXPECT_NEAR(focus[k].focus_D,
                to_D + (from_D - to_D) * std::exp(-static_cast<double>(k) / (60.0 * 0.2)), 1e-9);
  }
  const auto pupil = motionSteps("pupil", plane);
  EXPECT_NEAR(pupil[12].pupil_mm, 6.0, 1e-9);
  EXPECT_NEAR(pupil[36].pupil_mm, 3.6, 1e-9);
  const auto saccade = motionSteps("saccade", plane);
  EXPECT_EQ(std::ranges::count_if(saccade, &MotionStep::in_saccade), 3);
  EXPECT_NE(saccade.front().gaze_px, saccade.back().gaze_px);
  EXPECT_EQ(saccade[20].focus_D, from_D);  // within the latency of 0.3 s
  EXPECT_NE(saccade.back().focus_D, from_D);
}

TEST(PlanMotion, HasEverySceneAndMethod) {
  const MotionPlan full = planMotion({}), quick = planMotion({.quick = true});
  EXPECT_EQ(full.scenes.size(), 7u);
  EXPECT_EQ(quick.scenes.size(), 7u);
  EXPECT_EQ(full.frames, 48);
  const auto own = [](const EvaluatedMethod& method) {
    return methodInfo(method.spec()).family == MethodFamily::own;
  };
  EXPECT_FALSE(std::ranges::all_of(full.scenes[0].methods, own));
  EXPECT_TRUE(std::ranges::all_of(quick.scenes[0].methods, own));
  EXPECT_EQ(planMotion({.quick = true, .methods = {"paper"}}).scenes[0].methods.size(), 1u);
}

// A score of 0 means steadiness: in the frames that count, something moves.
TEST(MeasureMotion, SomethingMovesOnEveryPathOfAQuickRun) {
  MotionPlan plan =
      planMotion({.quick = true, .size_px = 24, .scenes = {"plane"}, .methods = {"pinhole"}});
  plan.views = 3;
  const TemporaryFolder folder;
  for (const MotionPoint& one :
       measureMotion(plan, {folder.path(), programKey(), OutputGuard()}, [](std::size_t) {}).rows) {
    EXPECT_GT(one.light_worst, 0.0) << one.path;
  }
}

// The reference's own views have almost no excess on any path: the LOD's nodes are the difference.
// A pinhole's pupil changes nothing, but the reference's does.
TEST(MeasureMotion, FindsNoExcessInTheReference) {
  MotionPlan plan = planMotion(
      {.quick = true, .size_px = 24, .scenes = {"plane"}, .methods = {"accumulate:3", "pinhole"}});
  plan.views = 3;
  const TemporaryFolder folder;
  const Measured<MotionPoint> result =
      measureMotion(plan, {folder.path(), programKey(), OutputGuard()}, [](std::size_t) {});
  ASSERT_EQ(result.rows.size(), 2 * kMotionPaths.size());
  for (const MotionPoint& one : result.rows) {
    if (one.method.name == "accumulate") {
      EXPECT_LT(one.light_worst, 0.002) << one.path;
      EXPECT_LT(one.jnd_worst, 0.1) << one.path;
    } else if (one.path == "pupil" || one.path == "focus") {
      EXPECT_GT(one.light_worst, 0.0) << one.path;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
