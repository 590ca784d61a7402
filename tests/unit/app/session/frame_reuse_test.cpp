// When the previous frame is reused, and that nobody sees the difference.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "app/session/session.h"
#include "app/study/session_settings_of.h"
#include "base/quantile.h"
#include "render/image/metrics.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRate_Hz = 250.0, kFps = 30.0;

/// A wall of coloured points, 2 m away on the left and 0.7 m on the right.
Scene steppedWall() {
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
  return {cloud};
}

/// A small screen of 27 px a degree, on which one dioptre of defocus gives a blur radius of 6 px.
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

/// Where the observer looks at a time, as fractions of the screen; nothing while the eye is shut.
using Gaze = std::function<std::optional<glm::dvec2>(double time_s)>;

constexpr glm::dvec2 kFar{0.3, 0.5}, kNear{0.7, 0.5};

/// Fixates two places at different depths in turn, with jumps of 60 ms, and shuts the eye for 0.2 s
/// at 1.5 s.
std::optional<glm::dvec2> jumping(double time_s) {
  constexpr double kPeriod_s = 1.1, kJump_s = 0.06;
  if (time_s > 1.5 && time_s < 1.7) return std::nullopt;
  const double in_s = std::fmod(time_s, kPeriod_s);
  const double share = std::clamp((in_s - (kPeriod_s - kJump_s)) / kJump_s, 0.0, 1.0);
  const bool back = std::fmod(time_s, 2.0 * kPeriod_s) > kPeriod_s;
  return glm::mix(kFar, kNear, back ? 1.0 - share : share);
}

/// A session that follows a gaze with 2 px of noise.
class Watch {
 public:
  Watch(const Study& watched, const Scene& scene, Gaze gaze)
      : study(watched),
        session(sessionSettingsOf(watched), scene, watched.screenInForce(), kRate_Hz, 0.0),
        gaze_(std::move(gaze)) {}

  FrameRecord look(double time_s) {
    for (; sample_s_ <= time_s; sample_s_ += 1.0 / kRate_Hz) {
      const glm::dvec2 noise_px(2.0 * std::sin(1e3 * sample_s_), 2.0 * std::cos(1.3e3 * sample_s_));
      GazeSample sample{.time_s = sample_s_};
      if (const auto at = gaze_(sample_s_)) {
        sample.point_px = *at * glm::dvec2(study.screen.size_px) + noise_px;
      } else {
        sample.blink = true;
      }
      session.push(sample);
    }
    return session.look(time_s);
  }

  Study study;
  Session session;

 private:
  Gaze gaze_;
  double sample_s_ = 0.0;
};

double focusOf(const RenderRequest& request) { return request.eyes[0].settings.defocus.focus_D; }

TEST(FrameReuse, AnEyeAtRestIsRenderedOnce) {
  const Scene scene = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.focus.fixed_D = 1.0;
    study.quality.foveated = foveated;
    Watch watch(study, scene, [](double) { return kFar; });
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

class FocusSteps : public testing::TestWithParam<double> {};

TEST_P(FocusSteps, AreATenthOfAPixelOfBlurForEachStepOfTolerance) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.quality.tolerance = GetParam();
  const double max_px = std::min(0.1 * GetParam(), kPx_per_D / 32.0);
  Watch watch(study, scene, [](double time_s) { return time_s < 2.0 ? kFar : kNear; });
  std::optional<RenderRequest> last;
  double before_D = 0.0;  // focus of the observer in the frame before
  int changes = 0, late = 0;
  constexpr double kRounding_px = 1e-4;  // requests are in float
  for (int i = 0; i < 480; ++i) {
    const FrameRecord record = watch.look(i / 120.0);
    const RenderRequest request = watch.session.requestOf("auto", record);
    const double focus_D = record.eye.focus_D;
    ASSERT_LE(kPx_per_D * std::abs(focusOf(request) - focus_D), max_px + kRounding_px);
    if (last && focusOf(request) != focusOf(*last)) {
      ++changes;
      late += i > 450;
      // Focus takes a step only when the last one is too far away.
      const double rest_D = focusOf(watch.session.requestAtRest("auto", record));
      if (focusOf(request) != rest_D) {
        EXPECT_GT(kPx_per_D * std::abs(focus_D - focusOf(*last)), max_px - kRounding_px);
      }
    }
    last = request;
    before_D = focus_D;
  }
  EXPECT_NEAR(before_D, 1.0 / 0.7, 0.02);
  // Focus goes from 2 m to 0.7 m in no more steps than needed, and then rests.
  const double sweep_px = kPx_per_D * (1.0 / 0.7 - 0.5);
  EXPECT_GE(changes, std::min(0.4 * sweep_px / max_px, 12.0));
  EXPECT_LE(changes, 2.0 * sweep_px / max_px + 10.0);
  EXPECT_EQ(late, 0);
}
INSTANTIATE_TEST_SUITE_P(Tolerances, FocusSteps, testing::Values(0.3, 1.0, 10.0));

TEST(FrameReuse, NoOneSeesThatAFrameIsReused) {
  const Scene scene = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.quality.foveated = foveated;
    Watch watch(study, scene, jumping);
    study.render.method = "auto:4";  // follows the eye exactly, at the same quality level
    Watch exact(study, scene, jumping);
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
    EXPECT_LE(worst, 0.25 * study.quality.tolerance)
        << foveated;  // the rest is for the errors of the method
    EXPECT_LT(rendered, 0.8 * frames) << foveated;
  }
}

TEST(FrameReuse, NothingIsRenderedInASaccadeOrABlink) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.quality.foveated = true;
  Watch watch(study, scene, jumping);
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

TEST(FrameReuse, AHeadThatMovesInASaccadeKeepsTheGazeBefore) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.quality.foveated = true;
  study.eye.path = {
      {.time_s = 0.0, .position_m = {0, 0, 0}, .look_at_m = {0, 0, -1}, .up = {}},
      {.time_s = 4.0, .position_m = {0.02, 0, 0}, .look_at_m = {0.02, 0, -1}, .up = {}}};
  Watch watch(study, scene, jumping);
  std::optional<RenderRequest> last;
  int saccades = 0;
  for (int i = 0; i < 110; ++i) {
    FrameRecord record = watch.look((i + 1) / 90.0);
    const RenderRequest request = watch.session.requestOf("auto", record);
    watch.session.render(request, record);
    EXPECT_TRUE(record.rendered);
    if (last && record.eye.state == GazeState::saccade) {
      ++saccades;
      EXPECT_EQ(request.eyes[0].settings, last->eyes[0].settings);
    }
    last = request;
  }
  EXPECT_GT(saccades, 3);
}

TEST(FrameReuse, ARunMayBeginInASaccadeOrWithoutGaze) {
  const Scene scene = steppedWall();
  const Gaze runs[] = {[](double time_s) { return glm::mix(kFar, kNear, 15.0 * time_s); },
                       [](double) { return std::nullopt; }};
  for (const bool foveated : {false, true}) {
    for (const Gaze& gaze : runs) {
      Study study = wallStudy();
      study.gaze.events.detector = Detector::rules;  // steady fast motion is a saccade
      study.quality.foveated = foveated;
      Watch watch(study, scene, gaze);
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

TEST(FrameReuse, EveryChangeOfAKeyIsRendered) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 1.0;
  Watch watch(study, scene, [](double) { return kFar; });
  double time_s = 0.1;
  const auto renderedNow = [&] {
    FrameRecord record = watch.look(time_s += 1.0 / kFps);
    watch.session.render(watch.study.render.method, record);
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
    changeLive(watch.study, watch.session, key, value);
    EXPECT_TRUE(renderedNow()) << key << " = " << value;
  }
}

TEST(FrameReuse, OtherMethodsRenderTheRecordAsItIsOnce) {
  const Scene scene = steppedWall();
  for (const char* method : {"sweep", "auto:4", "pinhole"}) {
    Study study = wallStudy();
    study.render.method = method;
    Watch watch(study, scene, [](double time_s) { return time_s < 0.5 ? kFar : kNear; });
    std::optional<double> before_D;
    int same = 0;
    for (int i = 0; i < 60; ++i) {
      FrameRecord record = watch.look(i / kFps);
      const RenderRequest request = watch.session.requestOf(method, record);
      EXPECT_EQ(focusOf(request), static_cast<float>(record.eye.focus_D));
      watch.session.render(request, record);
      EXPECT_EQ(record.rendered, before_D != focusOf(request)) << method;
      same += !record.rendered;
      before_D = focusOf(request);
    }
    EXPECT_GT(same, 5);  // during the latency of focus
  }
}

TEST(FrameReuse, AMethodThatMendsItsImageGoesOn) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 3.0;
  study.render.method = "fearing:20";
  Watch watch(study, scene, [](double) { return kFar; });
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

TEST(FrameReuse, ARestartedRunRendersItsFirstFrame) {
  const Scene scene = steppedWall();
  Study study = wallStudy();
  study.focus.fixed_D = 1.0;
  Watch watch(study, scene, [](double) { return kFar; });
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

TEST(FrameReuse, FramesAreThoseOfEveryRequestAtAnyNumberOfThreads) {
  const Scene scene = steppedWall();
  for (const bool foveated : {false, true}) {
    Study study = wallStudy();
    study.quality.foveated = foveated;
    std::vector<std::vector<Frame>> runs;
    std::vector<RenderRequest> requests;
    for (const unsigned threads : {1u, 4u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      Watch watch(study, scene, jumping);
      auto& frames = runs.emplace_back();
      requests.clear();
      for (int i = 0; i < 40; ++i) {
        FrameRecord record = watch.look(i / 15.0);
        requests.push_back(watch.session.requestOf("auto", record));
        frames.push_back(watch.session.render("auto", record));
      }
    }
    FrameRenderer renderer(scene);
    RenderedFrame rendered;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      renderer.render(requests[i], rendered);
      EXPECT_TRUE(rendered.frame.rgba == runs[0][i].rgba) << i;
      EXPECT_TRUE(runs[0][i].rgba == runs[1][i].rgba) << i;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
