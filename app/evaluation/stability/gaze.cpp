// Focus that follows a gaze beside a silhouette, under noise and data loss. The observers are foci
// and two simple ones: a mean over 0.1 s, and each sample as it comes. The reference is the same
// observer with the same gaze, without noise and data loss.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "app/evaluation/stability/setups.h"
#include "gaze/follow/gaze_follower.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/live/simulator.h"

namespace foci::stability {
namespace {

constexpr double kNear_D = 2.0, kFar_D = 0.5;  // left and right of the middle of the screen
constexpr double kFrames_Hz = 30.0;
// Chosen by eye.
constexpr double kSettled_s = 0.2;  // the score leaves out this start of a run
constexpr double kMean_s = 0.1;     // window of the observer that takes a mean
constexpr double kLoss_s = 0.08;    // mean duration of a stretch of data loss
constexpr unsigned kSeeds = 3;
const Screen kScreen{.size_px = {1280, 720}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

double atPoint_D(const glm::dvec2& point_px) {
  return lineOfSight(kScreen, point_px).x < 0.0 ? kNear_D : kFar_D;
}

struct Observer {
  enum class Kind { each_sample, mean, follower } kind;
  double rate_Hz;
};

Observer observerOf(std::size_t index) {
  using enum Observer::Kind;
  static constexpr Observer all[] = {{follower, 60.0},  {mean, 60.0},  {each_sample, 60.0},
                                     {follower, 250.0}, {mean, 250.0}, {each_sample, 250.0}};
  return all[index];
}

struct Samples {
  std::vector<GazeSample> clean, noisy;
};

/// Gaze at `targets`, clean and with Gaussian noise and data loss. Data loss is a Markov chain of
/// two states with stretches of `kLoss_s` on average.
/// @param lost  share of the samples that are missing, 0 to 1
Samples samplesOf(const std::vector<GazeTarget>& targets, double rate_Hz, double noise_deg,
                  double lost, unsigned seed) {
  Samples samples{
      simulateGaze(targets, kScreen, rate_Hz, seed,
                   {.drift_deg_s = 0.0, .tremor_deg = 0.0, .noise_deg = 0.0, .blink_rate_Hz = 0.0})
          .trace.samples,
      {}};
  std::mt19937 random(seed);
  const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) * 0x1p-32; };
  const double ends = 1.0 / std::max(1.0, kLoss_s * rate_Hz);
  const double begins = lost < 1.0 ? ends * lost / (1.0 - lost) : 1.0;
  bool is_lost = false;
  for (GazeSample sample : samples.clean) {
    is_lost = uniform() < (is_lost ? 1.0 - ends : begins);
    const double radius_deg = noise_deg * std::sqrt(-2.0 * std::log(uniform()));
    const double turn_rad = 2.0 * std::acos(-1.0) * uniform();
    if (is_lost) {
      sample.point_px.reset();
    } else {
      sample.point_px = pointAtEccentricity_px(
          kScreen, eccentricity_deg(kScreen, *sample.point_px) +
                       radius_deg * glm::dvec2(std::cos(turn_rad), std::sin(turn_rad)));
    }
    samples.noisy.push_back(sample);
  }
  return samples;
}

/// Mean of the samples since `since_s` that are not lost, before index `end`. With `last_only`: the
/// last of these samples.
std::optional<glm::dvec2> meanPoint_px(const std::vector<GazeSample>& samples, std::size_t end,
                                       double since_s, bool last_only) {
  glm::dvec2 sum_px(0.0);
  double count = 0.0;
  for (std::size_t i = end; i > 0 && samples[i - 1].time_s > since_s; --i) {
    if (!samples[i - 1].point_px) continue;
    sum_px += *samples[i - 1].point_px;
    ++count;
    if (last_only) break;
  }
  if (count == 0.0) return std::nullopt;
  return sum_px / count;
}

/// The observer's focus at the times of the frames.
std::vector<double> focus_D(const Observer& observer, const std::vector<GazeSample>& samples) {
  using enum Observer::Kind;
  FollowSettings settings;
  settings.accommodation.on = false;
  GazeFollower gaze(
      kScreen, observer.rate_Hz,
      [](double, const glm::dvec3& sight, double) {
        return std::optional(1.0 / (sight.x < 0.0 ? kNear_D : kFar_D));
      },
      settings);
  const double window_s = observer.kind == mean ? kMean_s : 1.5 / observer.rate_Hz;
  std::vector<double> frames;
  std::size_t next = 0;
  double now_D = kFar_D;
  const double end_s = samples.back().time_s;
  for (double time_s = kSettled_s; time_s < end_s; time_s += 1.0 / kFrames_Hz) {
    for (; next < samples.size() && samples[next].time_s <= time_s; ++next) {
      if (observer.kind == follower) gaze.push(samples[next]);
    }
    if (observer.kind == follower) {
      now_D = gaze.at(time_s).target_D.value_or(now_D);
    } else if (const auto point_px =
                   meanPoint_px(samples, next, time_s - window_s, observer.kind == each_sample)) {
      now_D = atPoint_D(*point_px);
    }
    frames.push_back(now_D);
  }
  return frames;
}

int jumpsIn(const std::vector<double>& frames) {
  int jumps = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) jumps += frames[i] != frames[i - 1];
  return jumps;
}

/// The score over all gazes and seeds.
double scoreOf(std::size_t index, const std::vector<std::vector<GazeTarget>>& gazes,
               double noise_deg, double lost, GazeScore score) {
  const Observer observer = observerOf(index);
  double wrong = 0.0, jumps = 0.0, count = 0.0;
  for (const auto& targets : gazes) {
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Samples samples = samplesOf(targets, observer.rate_Hz, noise_deg, lost, seed);
      const auto truth = focus_D(observer, samples.clean), noisy = focus_D(observer, samples.noisy);
      for (std::size_t i = 0; i < noisy.size(); ++i) wrong += noisy[i] != truth[i];
      jumps += std::max(0, jumpsIn(noisy) - jumpsIn(truth));
      count += static_cast<double>(noisy.size());
    }
  }
  return score == GazeScore::wrong_share ? wrong / count : jumps * kFrames_Hz / count;
}

GazeTarget target(double off_deg, double dwell_s) {
  return {pointAtEccentricity_px(kScreen, {off_deg, 0.0}), dwell_s};
}

}  // namespace

const std::vector<std::string> kObservers = {"foci, 60 Hz",           "mean of 0.1 s, 60 Hz",
                                             "each sample, 60 Hz",    "foci, 250 Hz",
                                             "mean of 0.1 s, 250 Hz", "each sample, 250 Hz"};

double gazeNoise(std::size_t observer, float noise_deg, GazeScore score) {
  std::vector<std::vector<GazeTarget>> gazes;
  for (const double off_deg : {-1.5, -1.0, -0.75, -0.5, 0.5, 0.75, 1.0, 1.5}) {
    gazes.push_back({target(off_deg, 8.0)});
  }
  return scoreOf(observer, gazes, noise_deg, 0.0, score);
}

double gazeLoss(std::size_t observer, float lost_percent, GazeScore score) {
  constexpr std::size_t kLooks = 10;
  std::vector<GazeTarget> targets;
  targets.reserve(kLooks);
  for (std::size_t k = 0; k < kLooks; ++k) targets.push_back(target(k % 2 == 0 ? -2.0 : 2.0, 1.5));
  return scoreOf(observer, {targets}, 0.3, 0.01 * double{lost_percent}, score);
}

}  // namespace foci::stability
