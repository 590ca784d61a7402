// A frame that would show nothing new is not rendered: when that is, and that nobody sees it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "app/session/session.h"
#include "base/quantile.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

constexpr double kRate_Hz = 250.0, kFps = 30.0;

/// A wall of coloured points, 2 m away on the left and 0.7 m on the right.
SurfelCloud steppedWall() {
  SurfelCloud cloud;
  std::uint32_t noise = 1;
  const auto next = [&] {
    noise = noise * 1664525u + 1013904223u;
    return static_cast<float>(noise >> 8) / static_cast<float>(1u << 24);
  };
  for (const auto& [sign, distance_m] : {std::pair{-1.0f, 2.0f}, std::pair{1.0f, 0.7f}}) {
    const float spacing_m = 0.004f * distance_m;
    for (int i = 0; i < 30; ++i) {
      for (int j = -20; j < 20; ++j) {
        appendSurfel(cloud,
                     {sign * spacing_m * (0.5f + static_cast<float>(i)),
                      spacing_m * (0.5f + static_cast<float>(j)), -distance_m},
                     {0, 0, 1}, spacing_m * kSigmaPerSpacing, spacing_m * spacing_m,
                     glm::vec3(next(), next(), next()));
      }
    }
  }
  return cloud;
}

/// On a small screen, an eighth of a degree a 3 px, where a dioptre blurs by 6 px.
Study wallStudy() {
  Study study;
  study.eye.position_m = glm::dvec3(0.0);
  study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
  study.screen.size_px = {256, 144};
  study.screen.size_m = {0.1, 0.05625};
  study.screen.distance_m = 0.6;
  study.observer.pupil_mm = 8.0;
  return study;
}

constexpr double kPx_per_D = 0.5 * 0.008 * 0.6 * 2560.0;
constexpr double kPx_per_deg = 0.6 * 2560.0 * 3.14159265358979 / 180.0;

/// Where the observer looks at a time, in parts of the screen; nothing where the eye is shut.
using Gaze = std::function<std::optional<glm::dvec2>(double time_s)>;

constexpr glm::dvec2 kFar{0.3, 0.5}, kNear{0.7, 0.5};

/// Fixates one of two places for a while, a step in depth apart, jumps within 60 ms to the other,
/// and so on; shuts the eye for a while at 1.5 s.
std::optional<glm::dvec2> jumping(double time_s) {
  constexpr double kPeriod_s = 1.1, kJump_s = 0.06;
  if (time_s > 1.5 && time_s < 1.7) return std::nullopt;
  const double in_s = std::fmod(time_s, kPeriod_s);
  const double share = std::clamp((in_s - (kPeriod_s - kJump_s)) / kJump_s, 0.0, 1.0);
  const bool back = std::fmod(time_s, 2.0 * kPeriod_s) > kPeriod_s;
  return glm::mix(kFar, kNear, back ? 1.0 - share : share);
}

/// Follows a gaze, whose noise is 2 px.
class Watch {
 public:
  Watch(const Study& study, const SurfelCloud& cloud, Gaze gaze)
      : session(study, cloud, study.screenInForce(), kRate_Hz, 0.0), gaze_(std::move(gaze)) {}

  FrameRecord look(double time_s) {
    for (; sample_s_ <= time_s; sample_s_ += 1.0 / kRate_Hz) {
      const glm::dvec2 noise_px(2.0 * std::sin(1e3 * sample_s_), 2.0 * std::cos(1.3e3 * sample_s_));
      GazeSample sample{.time_s = sample_s_};
      if (const auto at = gaze_(sample_s_)) {
        sample.point_px = *at * glm::dvec2(session.study().screen.size_px) + noise_px;
      } else {
        sample.blink = true;
      }
      session.push(sample);
    }
    return session.look(time_s);
  }

  Session session;

 private:
  Gaze gaze_;
  double sample_s_ = 0.0;
};

double focusOf(const RenderRequest& job) { return job.eyes[0].settings.defocus.focus_D; }

TEST(Hold, AnEyeAtRestIsPaintedOnce) {
  const SurfelCloud cloud = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.focus.fixed_D = 1.0;
    study.quality.foveated = foveated;
    Watch watch(study, cloud, [](double) { return kFar; });
    int rendered = 0;
    for (int i = 0; i < 60; ++i) {
      FrameRecord record = watch.look(0.1 + i / kFps);
      watch.session.render("auto", record);
      rendered += record.rendered;
      EXPECT_EQ(record.rendered, i == 0);
      EXPECT_EQ(record.stats.ms > 0.0, record.rendered);
      EXPECT_EQ(record.method, "auto");
    }
    EXPECT_EQ(rendered, 1) << foveated;
  }
}

class FocusHold : public testing::TestWithParam<double> {};

TEST_P(FocusHold, FocusOnItsWayIsDrawnToATenthOfAPixelForEachStepOfTolerance) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.quality.tolerance = GetParam();
  const double max_px = std::min(0.1 * GetParam(), kPx_per_D / 32.0);
  Watch watch(study, cloud, [](double time_s) { return time_s < 2.0 ? kFar : kNear; });
  std::optional<RenderRequest> last;
  double before_D = 0.0;  // focus as the record had it in the frame before
  int changes = 0, late = 0;
  constexpr double kRounding_px = 1e-4;  // jobs are in float
  for (int i = 0; i < 480; ++i) {
    const FrameRecord record = watch.look(i / 120.0);
    const RenderRequest job = watch.session.jobOf("auto", record);
    const double focus_D = record.eye.focus_D;
    ASSERT_LE(kPx_per_D * std::abs(focusOf(job) - focus_D), max_px + kRounding_px);
    if (last && focusOf(job) != focusOf(*last)) {
      ++changes;
      late += i > 450;
      // Not before it must: what was held until then is no more.
      const double rest_D = focusOf(watch.session.jobAtRest("auto", record));
      if (focusOf(job) != rest_D) {
        EXPECT_GT(kPx_per_D * std::abs(focus_D - focusOf(*last)), max_px - kRounding_px);
      }
    }
    last = job;
    before_D = focus_D;
  }
  EXPECT_NEAR(before_D, 1.0 / 0.7, 0.02);
  // From 2 m to 0.7 m, in no more steps than it takes; then it rests.
  const double sweep_px = kPx_per_D * (1.0 / 0.7 - 0.5);
  EXPECT_GE(changes, std::min(0.4 * sweep_px / max_px, 12.0));
  EXPECT_LE(changes, 2.0 * sweep_px / max_px + 10.0);
  EXPECT_EQ(late, 0);
}
INSTANTIATE_TEST_SUITE_P(Tolerances, FocusHold, testing::Values(0.3, 1.0, 10.0));

TEST(Hold, NoOneSeesThatAFrameIsNotDrawn) {
  const SurfelCloud cloud = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.quality.foveated = foveated;
    Watch watch(study, cloud, jumping);
    study.render.method = "auto:4";  // holds nothing; the same way is rendered on both sides
    Watch exact(study, cloud, jumping);
    int rendered = 0, frames = 0;
    float worst = 0.0f;
    for (; frames < 3.3 * kFps; ++frames) {
      FrameRecord record = watch.look(frames / kFps), same = exact.look(frames / kFps);
      const Frame& shown = watch.session.render("auto:4", record);
      rendered += record.rendered;
      const bool unseen =
          record.eye.state == GazeState::saccade || record.eye.state == GazeState::blink;
      if (foveated && unseen) continue;
      const Frame& wanted = exact.session.render("auto:4", same);
      auto apart = visibleDifference(shown, wanted, kPx_per_deg);
      worst = std::max(worst, quantile(apart, 0.95));
    }
    EXPECT_LE(worst, 0.25 * study.quality.tolerance) << foveated;  // the rest is the method's own
    EXPECT_LT(rendered, 0.8 * frames) << foveated;
  }
}

TEST(Hold, NothingIsPaintedInASaccadeOrABlink) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.quality.foveated = true;
  Watch watch(study, cloud, jumping);
  int saccades = 0, blinks = 0, landings = 0;
  std::optional<GazeState> before;
  for (int i = 0; i < 300; ++i) {
    FrameRecord record = watch.look((i + 1) / 90.0);
    watch.session.render("auto", record);
    const GazeState state = record.eye.state;
    if (before && (state == GazeState::saccade || state == GazeState::blink)) {
      EXPECT_FALSE(record.rendered) << record.time_s;
      ++(state == GazeState::saccade ? saccades : blinks);
    }
    if (before == GazeState::saccade && state == GazeState::fixation) {
      EXPECT_TRUE(record.rendered) << record.time_s;
      ++landings;
    }
    before = state;
  }
  EXPECT_GT(saccades, 5);
  EXPECT_GT(blinks, 5);
  EXPECT_GE(landings, 2);
}

TEST(Hold, AHeadThatMovesInASaccadeSeesThroughTheGazeBefore) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.quality.foveated = true;
  study.eye.path = {
      {.time_s = 0.0, .position_m = {0, 0, 0}, .look_at_m = {0, 0, -1}, .up = {}},
      {.time_s = 4.0, .position_m = {0.02, 0, 0}, .look_at_m = {0.02, 0, -1}, .up = {}}};
  Watch watch(study, cloud, jumping);
  std::optional<RenderRequest> last;
  int saccades = 0;
  for (int i = 0; i < 110; ++i) {
    FrameRecord record = watch.look((i + 1) / 90.0);
    const RenderRequest job = watch.session.jobOf("auto", record);
    watch.session.render(job, record);
    EXPECT_TRUE(record.rendered);
    if (last && record.eye.state == GazeState::saccade) {
      ++saccades;
      EXPECT_EQ(job.eyes[0].settings, last->eyes[0].settings);
    }
    last = job;
  }
  EXPECT_GT(saccades, 3);
}

TEST(Hold, ARunMayBeginInASaccadeOrWithoutGaze) {
  const SurfelCloud cloud = steppedWall();
  const Gaze runs[] = {[](double time_s) { return glm::mix(kFar, kNear, 15.0 * time_s); },
                       [](double) { return std::nullopt; }};
  for (const bool foveated : {false, true}) {
    for (const Gaze& gaze : runs) {
      Study study = wallStudy();
      study.quality.foveated = foveated;
      Watch watch(study, cloud, gaze);
      FrameRecord record = watch.look(0.06);
      EXPECT_FALSE(isStable(record.eye.state));
      const Frame& frame = watch.session.render("auto", record);
      EXPECT_TRUE(record.rendered);
      EXPECT_EQ(frame.size_px, study.imageSize_px());
      record = watch.look(0.07);
      watch.session.render("auto", record);
      EXPECT_FALSE(record.rendered);
    }
  }
}

TEST(Hold, WhatAChangeOfAKeyAsksForIsDrawn) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 1.0;
  Watch watch(study, cloud, [](double) { return kFar; });
  double time_s = 0.1;
  const auto renderedNow = [&] {
    FrameRecord record = watch.look(time_s += 1.0 / kFps);
    watch.session.render(watch.session.study().render.method, record);
    return record.rendered;
  };
  EXPECT_TRUE(renderedNow());
  const std::pair<const char*, const char*> changes[] = {
      {"observer.pupil_mm", "8.01"},       {"focus.fixed_D", "1.001"},
      {"quality.tolerance", "0.9"},        {"quality.foveated", "true"},
      {"eye.position_m", "[0.001, 0, 0]"}, {"scene.background", "[0, 0, 0.1]"},
      {"output.view", "\"side-by-side\""}, {"output.split", "true"},
      {"observer.chromatic", "true"},      {"render.shading", "0.1"},
      {"observer.ipd_mm", "63.01"},        {"render.method", "\"sweep-lod\""},
      {"render.method", "\"auto\""},
  };
  for (const auto& [key, value] : changes) {
    EXPECT_FALSE(renderedNow()) << "before " << key;
    watch.session.change(key, value);
    EXPECT_TRUE(renderedNow()) << key << " = " << value;
  }
}

TEST(Hold, OtherMethodsDrawWhatTheRecordSaysAndThatOnce) {
  const SurfelCloud cloud = steppedWall();
  for (const char* method : {"sweep", "auto:4", "pinhole"}) {
    Study study = wallStudy();
    study.render.method = method;
    Watch watch(study, cloud, [](double time_s) { return time_s < 0.5 ? kFar : kNear; });
    std::optional<double> before_D;
    int same = 0;
    for (int i = 0; i < 60; ++i) {
      FrameRecord record = watch.look(i / kFps);
      const RenderRequest job = watch.session.jobOf(method, record);
      EXPECT_EQ(focusOf(job), static_cast<float>(record.eye.focus_D));
      watch.session.render(job, record);
      EXPECT_EQ(record.rendered, before_D != focusOf(job)) << method;
      same += !record.rendered;
      before_D = focusOf(job);
    }
    EXPECT_GT(same, 5);  // while focus has not set off
  }
}

TEST(Hold, AMethodThatMendsItsImageGoesOn) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 3.0;
  study.render.method = "fearing:20";
  Watch watch(study, cloud, [](double) { return kFar; });
  std::vector<glm::vec4> first, last;
  for (int i = 0; i < 10; ++i) {
    FrameRecord record = watch.look(i / kFps);
    last = watch.session.render("fearing:20", record).rgba;
    if (i == 0) first = last;
    EXPECT_TRUE(record.rendered);
  }
  EXPECT_NE(first, last);
  FrameRecord record = watch.look(1.0);
  EXPECT_EQ(last, watch.session.render("fearing", record).rgba);  // mended by then
}

TEST(Hold, ARunStartedAgainDrawsItsFirstFrame) {
  const SurfelCloud cloud = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 1.0;
  Watch watch(study, cloud, [](double) { return kFar; });
  for (int i = 0; i < 3; ++i) {
    FrameRecord record = watch.look(1.0 + i / kFps);
    watch.session.render("auto", record);
    EXPECT_EQ(record.rendered, i == 0);
  }
  watch.session.restart(2.0);
  FrameRecord record = watch.look(2.1);
  watch.session.render("auto", record);
  EXPECT_TRUE(record.rendered);
}

TEST(Hold, ImagesAreThoseOfEveryJobPaintedAtAnyNumberOfThreads) {
  const SurfelCloud cloud = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.quality.foveated = foveated;
    std::vector<std::vector<Frame>> runs;
    std::vector<RenderRequest> jobs;
    for (const unsigned threads : {1u, 4u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      Watch watch(study, cloud, jumping);
      auto& frames = runs.emplace_back();
      jobs.clear();
      for (int i = 0; i < 40; ++i) {
        FrameRecord record = watch.look(i / 15.0);
        jobs.push_back(watch.session.jobOf("auto", record));
        frames.push_back(watch.session.render("auto", record));
      }
    }
    FrameRenderer renderer(cloud);
    RenderedFrame rendered;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      renderer.render(jobs[i], rendered);
      EXPECT_TRUE(rendered.frame.rgba == runs[0][i].rgba) << i;
      EXPECT_TRUE(runs[0][i].rgba == runs[1][i].rgba) << i;
    }
  }
}

}  // namespace
}  // namespace foci
