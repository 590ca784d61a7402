#include "gaze/follow/gaze_follower.h"

#include <gtest/gtest.h>

#include <utility>

#include "gaze/geometry/line_of_sight.h"
#include "gaze/live/simulator.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;  // a handful of double operations

const Screen kScreen{.size_px = {1280, 720}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};
const glm::dvec2 kLeft_px{300, 360}, kRight_px{1000, 360};

/// A near surface on the left, a far one on the right, and none above.
std::optional<double> twoSurfaces(double, const glm::dvec3& direction, double) {
  if (direction.y > 0.1) return std::nullopt;
  return direction.x < 0.0 ? 0.5 : 2.0;
}

FollowSettings instant() {
  FollowSettings settings;
  settings.accommodation.on = false;
  return settings;
}

/// Pushes `samples` into a follower up to the time of each frame.
class Feed {
 public:
  Feed(GazeFollower& follower, const std::vector<GazeSample>& samples)
      : follower_(follower), samples_(samples) {}

  EyeNow at(double time_s) {
    while (next_ < samples_.size() && samples_[next_].time_s <= time_s) {
      follower_.push(samples_[next_++]);
    }
    return follower_.at(time_s);
  }

 private:
  GazeFollower& follower_;
  const std::vector<GazeSample>& samples_;
  std::size_t next_ = 0;
};

std::vector<GazeSample> still(double from_s, double to_s, std::optional<glm::dvec2> point_px) {
  std::vector<GazeSample> samples;
  for (double time_s = from_s; time_s < to_s; time_s += 0.002) {
    samples.push_back({.time_s = time_s, .point_px = point_px});
  }
  return samples;
}

void append(std::vector<GazeSample>& samples, const std::vector<GazeSample>& more) {
  samples.insert(samples.end(), more.begin(), more.end());
}

TEST(GazeFollower, KnowsNothingBeforeTheFirstSample) {
  GazeFollower follower(kScreen, 500, twoSurfaces);
  const EyeNow eye = follower.at(0.0);
  EXPECT_EQ(eye.state, GazeState::lost);
  EXPECT_FALSE(eye.sample || eye.fixation_px || eye.surface_distance_m || eye.target_D);
  EXPECT_EQ(eye.focus_D, AccommodationSettings{}.resting_D);
}

TEST(GazeFollower, FocusesWhatIsFixated) {
  const auto samples = still(0.0, 1.0, kLeft_px);
  GazeFollower follower(kScreen, 500, twoSurfaces);
  const EyeNow eye = Feed(follower, samples).at(0.5);
  EXPECT_EQ(eye.state, GazeState::fixation);
  EXPECT_LT(glm::distance(*eye.fixation_px, kLeft_px), kRounding);
  EXPECT_EQ(eye.surface_distance_m, 0.5);
  EXPECT_EQ(eye.target_D, 2.0);
  EXPECT_EQ(eye.focus_D, 2.0);
}

/// Samples of a tracker that sends batches arrive after a frame that is later than they are.
TEST(GazeFollower, TakesSamplesThatAreOlderThanTheLastFrame) {
  GazeFollower follower(kScreen, 500.0, twoSurfaces);
  const auto samples = still(0.0, 2.0, kLeft_px);
  for (std::size_t i = 0; i < 500; ++i) follower.push(samples[i]);
  EXPECT_NEAR(*follower.at(1.4).target_D, 2.0, kRounding);
  for (std::size_t i = 500; i < samples.size(); ++i) {
    GazeSample sample = samples[i];
    sample.point_px = kRight_px;
    follower.push(sample);
  }
  EXPECT_NEAR(*follower.at(2.0).target_D, 0.5, kRounding);
  EXPECT_NEAR(follower.at(6.0).focus_D, 0.5, 1e-3);
}

TEST(GazeFollower, KeepsItsTargetThroughBlinksDataLossAndMisses) {
  auto samples = still(0.0, 0.5, kLeft_px);
  append(samples, still(0.5, 1.5, std::nullopt));
  append(samples, still(1.5, 2.0, glm::dvec2(300, 60)));
  GazeFollower follower(kScreen, 500, twoSurfaces, instant());
  Feed feed(follower, samples);
  const struct {
    double time_s;
    GazeState state;
  } expected[] = {{0.51, GazeState::fixation},  // the newest labelled sample still had gaze
                  {0.7, GazeState::blink},
                  {1.3, GazeState::lost},
                  {1.8, GazeState::fixation},  // on no surface
                  {2.5, GazeState::lost}};     // after the last sample
  for (const auto& [time_s, state] : expected) {
    const EyeNow eye = feed.at(time_s);
    EXPECT_EQ(eye.state, state) << time_s;
    EXPECT_EQ(eye.target_D, 2.0) << time_s;
    EXPECT_EQ(eye.focus_D, 2.0) << time_s;
    EXPECT_EQ(eye.surface_distance_m.has_value(), time_s < 0.52) << time_s;
    EXPECT_TRUE(eye.fixation_px) << time_s;
  }
}

TEST(GazeFollower, KeepsTheFixationDuringASaccade) {
  const auto simulated = simulateGaze({{kLeft_px, 1.0}, {kRight_px, 1.0}}, kScreen, 500, 3,
                                      {.noise_deg = 0.01, .blink_rate_Hz = 0.0});
  GazeFollower follower(kScreen, 500, twoSurfaces, instant());
  bool saccade = false, landed = false;
  for (std::size_t i = 0; i < simulated.trace.samples.size(); ++i) {
    const GazeSample& sample = simulated.trace.samples[i];
    follower.push(sample);
    const EyeNow eye = follower.at(sample.time_s);
    ASSERT_TRUE(eye.fixation_px);
    const double left_deg = angleBetween_deg(kScreen, *eye.fixation_px, kLeft_px);
    const double right_deg = angleBetween_deg(kScreen, *eye.fixation_px, kRight_px);
    if (eye.state == GazeState::saccade && !landed) {
      saccade = true;
      EXPECT_LT(left_deg, 1.0);
      EXPECT_EQ(eye.target_D, 2.0);
      EXPECT_FALSE(eye.surface_distance_m);
    } else if (saccade && isStable(eye.state)) {
      landed = true;
    }
    EXPECT_EQ(eye.target_D, landed ? 0.5 : 2.0);
    if (landed) {
      EXPECT_LT(right_deg, 3.0);
    }
  }
  EXPECT_TRUE(landed);
}

// Accommodation starts at the sample where the fixation begins, at any frame rate.
TEST(GazeFollower, FocusAtATimeDoesNotDependOnTheFramesBefore) {
  const auto simulated = simulateGaze({{kLeft_px, 0.6}, {kRight_px, 0.9}}, kScreen, 500, 5);
  double focus_D[2], target_D[2];
  for (int run : {0, 1}) {
    GazeFollower follower(kScreen, 500, twoSurfaces);
    Feed feed(follower, simulated.trace.samples);
    for (double time_s = 0.0; time_s < 1.25; time_s += run == 0 ? 1.0 / 30.0 : 0.0004) {
      feed.at(time_s);
    }
    const EyeNow eye = feed.at(1.3);
    focus_D[run] = eye.focus_D;
    target_D[run] = *eye.target_D;
  }
  EXPECT_EQ(target_D[0], 0.5);
  EXPECT_LT(focus_D[0], 1.9);  // still moving towards the target
  EXPECT_EQ(focus_D[0], focus_D[1]);
  EXPECT_EQ(target_D[0], target_D[1]);
}

TEST(GazeFollower, AsksTheSurfaceOnceAFrameAndNotAtEverySample) {
  int asked = 0;
  std::vector<double> times_s;
  const auto count = [&](double time_s, const glm::dvec3&, double) {
    ++asked;
    times_s.push_back(time_s);
    return std::optional(1.0 + time_s);  // the eye approaches
  };
  const auto samples = still(0.0, 2.0, kLeft_px);
  GazeFollower follower(kScreen, 500, count, instant());
  Feed feed(follower, samples);
  for (int frame = 1; frame <= 30; ++frame) {
    const double time_s = frame / 30.0;
    EXPECT_DOUBLE_EQ(*feed.at(time_s).surface_distance_m, 1.0 + time_s);
    follower.at(time_s);
  }
  EXPECT_EQ(asked, 31);  // once when the fixation began
  EXPECT_TRUE(std::is_sorted(times_s.begin(), times_s.end()));
}

TEST(GazeFollower, AReaderOfStatesAsksOnlyOnceGazeOrTheEyeHasMoved) {
  int asked = 0;
  const auto count = [&](double, const glm::dvec3&, double) {
    ++asked;
    return std::optional(1.0);
  };
  GazeFollower follower(kScreen, 500, count, instant());
  // 0.5 px of noise; the cone's half-angle is 13 px.
  auto samples = still(0.0, 1.0, kLeft_px);
  for (std::size_t i = 0; i < samples.size(); i += 2) samples[i].point_px->x += 0.5;
  const auto readAll = [&] {
    for (const GazeSample& sample : samples) {
      follower.push(sample);
      EXPECT_EQ(follower.at(sample.time_s, AskSurface::whenMoved).surface_distance_m, 1.0);
    }
    return std::exchange(asked, 0);
  };
  EXPECT_EQ(readAll(), 1);  // as the fixation began

  samples = still(1.0, 2.0, kLeft_px + glm::dvec2(5.0, 0.0));
  const int drifting = readAll();
  EXPECT_GE(drifting, 1);
  EXPECT_LE(drifting, 10);

  follower.noteEyeMoved();
  follower.at(2.0, AskSurface::whenMoved);
  follower.at(2.001, AskSurface::whenMoved);
  EXPECT_EQ(std::exchange(asked, 0), 1);
  follower.at(2.002);
  EXPECT_EQ(asked, 1);  // for a frame, always
}

/// An observer looks steadily at a point, `off_deg` to the right of the edge between two surfaces.
/// Returns the share of the time with the focus on the wrong surface.
double wrongShare(double rate_Hz, double off_deg, double noise_deg, unsigned seed) {
  const auto simulated = simulateGaze(
      {{pointAtEccentricity_px(kScreen, {off_deg, 0.0}), 8.0}}, kScreen, rate_Hz, seed,
      {.drift_deg_s = 0.0, .tremor_deg = 0.0, .noise_deg = noise_deg, .blink_rate_Hz = 0.0});
  GazeFollower follower(kScreen, rate_Hz, twoSurfaces, instant());
  Feed feed(follower, simulated.trace.samples);
  double wrong = 0.0, frames = 0.0;
  for (double time_s = 0.1; time_s < 8.0; time_s += 1.0 / 30.0) {
    wrong += *feed.at(time_s).target_D != (off_deg < 0.0 ? 2.0 : 0.5);
    ++frames;
  }
  return wrong / frames;
}

// Means over the last 0.1 s are six samples at 60 Hz, with an error of 0.41 deg. At these distances
// from the edge they would be wrong for 7 % of the time; at 250 Hz and 1.6 deg of noise, for 3.4 %.
TEST(GazeFollower, KeepsASurfaceThroughNoiseAtASilhouette) {
  double slow = 0.0, fast = 0.0;
  for (const double off_deg : {-0.75, -0.5, 0.5, 0.75}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      slow += wrongShare(60, off_deg, 1.0, seed) / 12.0;
      fast += wrongShare(250, off_deg, 1.6, seed) / 12.0;
    }
  }
  EXPECT_LT(slow, 0.073 / 3.0);
  EXPECT_LT(fast, 0.034 / 3.0);
  EXPECT_EQ(wrongShare(60, -0.5, 0.03, 1), 0.0);
}

// The focus still follows gaze that crosses the edge by more than the noise.
TEST(GazeFollower, FollowsASaccadeAcrossASilhouetteInNoise) {
  const auto simulated = simulateGaze({{pointAtEccentricity_px(kScreen, {-2.0, 0.0}), 2.0},
                                       {pointAtEccentricity_px(kScreen, {2.0, 0.0}), 2.0}},
                                      kScreen, 250, 3, {.noise_deg = 0.5, .blink_rate_Hz = 0.0});
  GazeFollower follower(kScreen, 250, twoSurfaces, instant());
  Feed feed(follower, simulated.trace.samples);
  EXPECT_EQ(*feed.at(1.9).target_D, 2.0);
  EXPECT_EQ(*feed.at(2.5).target_D, 0.5);
}

}  // namespace FOCI_FILE
}  // namespace foci
