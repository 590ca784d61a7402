// Saccades have the durations of Carpenter (1988) and the minimum-jerk course of Flash and Hogan
// (1985). Drift is a smooth random walk. Blinks come at random times.
#include "gaze/live/simulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>

#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

// Duration of a saccade: 21 ms and 2.2 ms per degree. The peak velocity of a minimum-jerk course is
// 15/8 of its mean velocity.
constexpr double kMinDuration_s = 0.021;
constexpr double kDurationPerDegree_s = 0.0022;

// Chosen by eye, within the usual ranges.
constexpr double kMinLatency_s = 0.08;         // a faster saccade is no response to the target
constexpr double kMinPause_s = 0.05;           // between two saccades
constexpr double kCorrectionLatency_s = 0.15;  // of a corrective saccade
constexpr double kCorrected_deg = 1.0;         // smaller errors are not corrected
constexpr double kDriftMemory_s = 0.2;         // how long drift keeps its direction
constexpr double kBlinkPause_s = 0.5;          // minimum, between two blinks
constexpr double kMinBlink_s = 0.08;
constexpr glm::dvec2 kTremor_Hz{81.0,
                                89.0};  // along x and y; different, so that it has no direction

/// std::mt19937_64 gives the same bits everywhere. The standard library's distributions do not, so
/// they are written out here.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : bits_(seed) {}

  /// In (0, 1).
  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }

  /// Mean 0, variance 1 (Box and Muller); two at a time.
  glm::dvec2 normals() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
  }

  double normal() { return normals().x; }
  double exponential(double mean) { return -mean * std::log(uniform()); }

 private:
  std::mt19937_64 bits_;
};

struct Saccade {
  double onset_s = 0.0, duration_s = 0.0;
  glm::dvec2 from_deg{0.0}, to_deg{0.0};
};

glm::dvec2 positionIn_deg(const Saccade& saccade, double time_s) {
  const double u = std::clamp((time_s - saccade.onset_s) / saccade.duration_s, 0.0, 1.0);
  const double part = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  return saccade.from_deg + part * (saccade.to_deg - saccade.from_deg);
}

class Observer {
 public:
  Observer(const std::vector<GazeTarget>& targets, const Screen& screen, std::uint64_t seed,
           const OculomotorSettings& settings)
      : chance_(seed), settings_(settings) {
    double appears_s = 0.0;
    for (const GazeTarget& target : targets) {
      assert(target.dwell_s > 0.0);
      const glm::dvec2 point_deg = eccentricity_deg(screen, target.point_px);
      if (plans_.empty() && appears_s == 0.0) {
        eye_deg_ = point_deg;
      } else {
        const double latency_s = settings.latency_s + settings.latency_sd_s * chance_.normal();
        plans_.push_back({appears_s + std::max(latency_s, kMinLatency_s), point_deg, false});
      }
      appears_s += target.dwell_s;
    }
    tremor_phase_ = 2.0 * std::numbers::pi * glm::dvec2(chance_.uniform(), chance_.uniform());
    drift_deg_s_ = driftScale() * chance_.normals();
    planBlink(0.0);
  }

  /// Gaze in degrees, and the eye's state. @param time_s  never decreases
  std::pair<glm::dvec2, GazeState> at(double time_s) {
    if (saccade_ && time_s >= saccade_->onset_s + saccade_->duration_s) endSaccade();
    if (!saccade_ && !plans_.empty() && time_s >= plans_.front().onset_s &&
        time_s >= rests_until_s_) {
      startSaccade(time_s);
    }
    if (saccade_) {
      eye_deg_ = positionIn_deg(*saccade_, time_s);
    } else {
      drift(time_s - time_s_);
    }
    time_s_ = time_s;
    if (time_s >= blink_s_ + blink_duration_s_) planBlink(time_s);
    const GazeState state = time_s >= blink_s_ ? GazeState::blink
                            : saccade_         ? GazeState::saccade
                                               : GazeState::fixation;
    const glm::dvec2 tremor =
        std::numbers::sqrt2 * settings_.tremor_deg *
        glm::sin(2.0 * std::numbers::pi * time_s * kTremor_Hz + tremor_phase_);
    return {eye_deg_ + tremor + settings_.noise_deg * chance_.normals(), state};
  }

 private:
  struct Plan {
    double onset_s = 0.0;
    glm::dvec2 point_deg{0.0};
    bool correction = false;
  };

  /// Standard deviation of the drift's velocity along each axis. The mean speed is the mean of a
  /// Rayleigh distribution, sqrt(pi / 2) sigma.
  double driftScale() const { return settings_.drift_deg_s / std::sqrt(0.5 * std::numbers::pi); }

  void drift(double step_s) {
    const double keep = std::exp(-step_s / kDriftMemory_s);
    eye_deg_ += step_s * drift_deg_s_;
    drift_deg_s_ =
        keep * drift_deg_s_ + std::sqrt(1.0 - keep * keep) * driftScale() * chance_.normals();
  }

  void startSaccade(double time_s) {
    // Of several plans that are due, the eye follows the latest.
    while (plans_.size() > 1 && plans_[1].onset_s <= time_s) plans_.pop_front();
    goal_ = plans_.front();
    plans_.pop_front();
    const double amplitude_deg = glm::length(goal_.point_deg - eye_deg_);
    saccade_ = {
        .onset_s = time_s,
        .duration_s = kMinDuration_s + kDurationPerDegree_s * amplitude_deg,
        .from_deg = eye_deg_,
        .to_deg = goal_.point_deg + settings_.landing_error * amplitude_deg * chance_.normals()};
  }

  void endSaccade() {
    eye_deg_ = saccade_->to_deg;
    rests_until_s_ = saccade_->onset_s + saccade_->duration_s + kMinPause_s;
    const double again_s = rests_until_s_ - kMinPause_s + kCorrectionLatency_s;
    const bool missed = glm::length(goal_.point_deg - eye_deg_) > kCorrected_deg;
    if (missed && !goal_.correction && (plans_.empty() || again_s < plans_.front().onset_s)) {
      plans_.push_front({again_s, goal_.point_deg, true});
    }
    saccade_.reset();
  }

  void planBlink(double time_s) {
    blink_s_ = settings_.blink_rate_Hz > 0.0
                   ? time_s + kBlinkPause_s + chance_.exponential(1.0 / settings_.blink_rate_Hz)
                   : INFINITY;
    blink_duration_s_ =
        std::max(settings_.blink_duration_s * (1.0 + 0.2 * chance_.normal()), kMinBlink_s);
  }

  Chance chance_;
  OculomotorSettings settings_;
  std::deque<Plan> plans_;
  Plan goal_;
  std::optional<Saccade> saccade_;
  double rests_until_s_ = 0.0;
  double time_s_ = 0.0;
  glm::dvec2 eye_deg_{0.0}, drift_deg_s_{0.0}, tremor_phase_{0.0};
  double blink_s_ = 0.0, blink_duration_s_ = 0.0;
};

}  // namespace

SimulatedGaze simulateGaze(const std::vector<GazeTarget>& targets, const Screen& screen,
                           double rate_Hz, std::uint64_t seed, const OculomotorSettings& settings) {
  assert(!targets.empty() && rate_Hz >= 10.0 && rate_Hz <= 20'000.0);
  SimulatedGaze result;
  result.trace.format = "simulated";
  result.trace.screen = screen;
  result.trace.rate_Hz = rate_Hz;
  result.trace.simulated = true;
  double duration_s = 0.0;
  for (const GazeTarget& target : targets) duration_s += target.dwell_s;
  Observer observer(targets, screen, seed, settings);
  for (std::size_t i = 0; static_cast<double>(i) / rate_Hz < duration_s; ++i) {
    GazeSample sample{.time_s = static_cast<double>(i) / rate_Hz};
    const auto [point_deg, state] = observer.at(sample.time_s);
    sample.blink = state == GazeState::blink;
    if (!sample.blink) sample.point_px = pointAtEccentricity_px(screen, point_deg);
    result.trace.samples.push_back(sample);
    result.states.push_back(state);
  }
  return result;
}

}  // namespace foci
