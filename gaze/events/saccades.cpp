// After Nystrom and Holmqvist (2010): the thresholds of peak and edge follow the noise, and a
// glissade may follow a saccade.
//
// `EventRules` holds the constants that labelled recordings choose. The others without a source
// were fitted once to the coders of 21 labelled recordings (Andersson et al. 2017 and irf), as they
// are, and with added white noise of up to a degree at 30 to 1000 Hz.

#include "gaze/events/saccades.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

using Velocities = std::vector<std::optional<SightVelocity>>;

// Narrow windows.
constexpr double kMinSaccade_s = 0.0045;  // minimum time above the edges' threshold
// A motion so soon after a saccade is part of its oscillation if it is smaller (`echo_ratio`).
constexpr double kEcho_s = 0.02;

// The choice of windows.
constexpr double kClearPeak_deg_s = 95.0;  // the next window must reach a threshold below this
constexpr double kWhite = 1.4;             // tolerance for "the noise falls like white noise"
constexpr double kWhiteAndSteps = 2.0;     // the same if each window may hold a saccade

// Wide windows.
constexpr double kApart = 0.2;               // of a window, from other saccades to a wide one
constexpr double kWideOscillation_s = 0.02;  // duration of a typical oscillation
constexpr double kDuration_s = 0.021, kDurationPerDegree_s = 0.0022;  // Carpenter (1988)

// Blinks.
constexpr double kLidReach_s = 0.3;  // motion this close to data loss may be the eyelid's

/// Number of samples in a window of this length.
double samplesIn(double window_s, double rate_Hz) {
  return 2.0 * std::floor(0.5 * window_s * rate_Hz + 1e-3) + 1.0;
}

class SaccadeFinder {
 public:
  SaccadeFinder(std::span<const TimedSight> sights, double rate_Hz, const SightNoise& noise,
                const EventSettings& settings)
      : sights_(sights),
        rate_Hz_(rate_Hz),
        noise_(noise),
        settings_(settings),
        rules_(settings.rules),
        states_(sights.size(), GazeState::fixation) {}

  std::vector<GazeState> find(const std::vector<bool>& blinks) {
    const bool narrow = window_s(0) <= kWide_s;
    const std::size_t finest = narrow && noiseBlursNarrow() ? 1 : 0;
    if (narrow) findNarrow(finest);
    bool hidden =
        narrow && rules_.hidden_noise * noise_.velocity_deg_s[finest] > settings_.saccade_deg_s;
    for (std::size_t scale = narrow ? finest + 1 : 0; scale < kNoiseScales; ++scale) {
      if (scale > 0 && (!hidden || window_s(scale) > kMaxNoiseWindow_s || !isWhite(scale))) break;
      const double floor_deg_s = scale == 0 ? settings_.saccade_deg_s : kWidePeak_deg_s;
      findWide(scale, floor_deg_s);
      hidden = rules_.hidden_noise * noise_.velocity_deg_s[scale] > kWidePeak_deg_s;
    }
    markBlinks(blinks);
    return std::move(states_);
  }

 private:
  double window_s(std::size_t scale) const { return scaleWindow_s(scale, rate_Hz_, settings_); }
  double time_s(std::size_t i) const { return sights_[i].time_s; }

  /// Whether the noise falls from one scale to the next as white noise does.
  bool isWhite(std::size_t scale) const {
    const double n = samplesIn(window_s(scale), rate_Hz_);
    const double before = samplesIn(window_s(scale - 1), rate_Hz_);
    const double falls = std::sqrt(before * (before * before - 1.0) / (n * (n * n - 1.0)));
    const double white = window_s(0) > kWide_s ? kWhiteAndSteps : kWhite;
    return noise_.velocity_deg_s[scale] <= white * falls * noise_.velocity_deg_s[scale - 1];
  }

  /// Two windows are shorter than most saccades. The shorter one shows the edges better, but only
  /// if the noise leaves them visible. True if the noise asks for the longer one.
  bool noiseBlursNarrow() const {
    return window_s(1) <= kWide_s + 1e-6 &&
           rules_.peak_noise * noise_.velocity_deg_s[0] > kBlurredPeak_deg_s &&
           rules_.peak_noise * noise_.velocity_deg_s[1] <= kClearPeak_deg_s;
  }

  void mark(std::size_t first, std::size_t last, GazeState state) {
    std::ranges::fill(std::span(states_).subspan(first, last + 1 - first), state);
  }

  /// Finds saccades with a window that is shorter than most of them, so that it shows their edges.
  void findNarrow(std::size_t scale) {
    const double sigma_deg_s = noise_.velocity_deg_s[scale];
    const double peak_deg_s = std::max(settings_.saccade_deg_s, rules_.peak_noise * sigma_deg_s);
    const double edge_deg_s =
        std::min(std::max(rules_.edge_deg_s, rules_.edge_noise * sigma_deg_s), peak_deg_s);
    const double rest_deg_s = std::max(rules_.rest_deg_s, rules_.rest_noise * sigma_deg_s);
    const auto min_samples = static_cast<std::size_t>(kMinSaccade_s * rate_Hz_);
    const Velocities velocities =
        velocitiesOfSight(sights_, window_s(scale), longestStep_s(rate_Hz_));
    const auto speed_deg_s = [&](std::size_t i) {
      return velocities[i] ? velocities[i]->speed_deg_s : 0.0;
    };

    std::optional<std::size_t> end;  // last sample of the latest saccade with its oscillation
    double amplitude_deg = 0.0;      // of the latest saccade
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      // A window that is cut by data loss or by the newest sample has more noise.
      if (speed_deg_s(i) <= peak_deg_s ||
          speed_deg_s(i) <= rules_.peak_noise * sigma_deg_s * velocities[i]->noise_gain) {
        continue;
      }
      // Find the peak of speed, as long as the direction stays the same.
      std::size_t peak = i;
      for (std::size_t j = i + 1; j < sights_.size() && speed_deg_s(j) > edge_deg_s; ++j) {
        if (speed_deg_s(j) > speed_deg_s(peak)) {
          peak = j;
        } else if (glm::dot(velocities[j]->deg_s, velocities[peak]->deg_s) <=
                   edge_deg_s * speed_deg_s(peak)) {
          break;
        }
      }
      // Find both edges.
      const glm::dvec3 along = velocities[peak]->deg_s / speed_deg_s(peak);
      std::size_t first = peak, last = peak;
      while (first > (end ? *end + 1 : 0) && speed_deg_s(first - 1) > edge_deg_s) --first;
      while (last + 1 < sights_.size() && velocities[last + 1] &&
             glm::dot(velocities[last + 1]->deg_s, along) > edge_deg_s) {
        ++last;
      }

      // Label the samples between the edges.
      const double moved_deg =
          glm::degrees(glm::distance(*sights_[first].direction, *sights_[last].direction));
      if (end && time_s(first) - time_s(*end) <= kEcho_s &&
          moved_deg < rules_.echo_ratio * amplitude_deg) {
        mark(*end + 1, last, GazeState::oscillation);
      } else if (last - first + 1 >= min_samples) {
        mark(first, last, GazeState::saccade);
        amplitude_deg = moved_deg;
      } else {
        i = last;
        continue;
      }

      // Label the oscillation behind the saccade.
      end = last;
      for (std::size_t j = last + 1;
           j < sights_.size() && velocities[j] && speed_deg_s(j) <= peak_deg_s &&
           time_s(j) - time_s(*end) <= rules_.rest_s &&
           time_s(j) - time_s(last) <= rules_.oscillation_s;
           ++j) {
        if (speed_deg_s(j) > rest_deg_s) end = j;
      }
      if (*end > last) mark(last + 1, *end, GazeState::oscillation);
      i = *end;
    }
  }

  /// Finds saccades with a window that is longer than most of them. It shows where a saccade was,
  /// but not its edges.
  void findWide(std::size_t scale, double floor_deg_s) {
    const double width_s = window_s(scale);
    const Velocities velocities = velocitiesOfSight(sights_, width_s, longestStep_s(rate_Hz_));
    const auto thresholdAt = [&](std::size_t i) {
      return std::max(floor_deg_s,
                      rules_.wide_noise * velocities[i]->noise_gain * noise_.velocity_deg_s[scale]);
    };
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      if (velocities[i] && velocities[i]->speed_deg_s > thresholdAt(i)) candidates.push_back(i);
    }
    std::ranges::sort(candidates, [&](std::size_t a, std::size_t b) {
      const double fast_a = velocities[a]->speed_deg_s, fast_b = velocities[b]->speed_deg_s;
      return fast_a != fast_b ? fast_a > fast_b : a < b;
    });

    std::vector<bool> taken(sights_.size());
    const auto take = [&](std::size_t i, double reach_s) {
      const auto reach = static_cast<std::size_t>(reach_s * rate_Hz_);
      const std::size_t end = std::min(i + reach + 1, sights_.size());
      for (std::size_t j = i - std::min(i, reach); j < end; ++j) taken[j] = true;
    };
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      const bool border = i == 0 || i + 1 == sights_.size() ||
                          states_[i - 1] == GazeState::fixation ||
                          states_[i + 1] == GazeState::fixation;
      if (states_[i] != GazeState::fixation) take(i, border ? kApart * width_s : 0.0);
    }
    for (const std::size_t peak : candidates) {
      if (taken[peak]) continue;
      take(peak, width_s);
      markTypical(peak, width_s, velocities, scale == 0, thresholdAt(peak));
    }
  }

  /// Marks a saccade with the duration that is typical of its amplitude (Carpenter 1988). The slope
  /// over a window T peaks at 1.5 A / T for a step of amplitude A.
  /// @param few  the window holds few samples. The saccade then ends with its last fast step, and
  ///             no sample shows an oscillation
  /// @param fast_deg_s  a step is fast from here on
  void markTypical(std::size_t peak, double width_s, const Velocities& velocities, bool few,
                   double fast_deg_s) {
    const double amplitude_deg = velocities[peak]->speed_deg_s * width_s / 1.5;
    const double half_s = 0.5 * (kDuration_s + kDurationPerDegree_s * amplitude_deg);
    const double centre_s = few ? centreOfSteps_s(peak, width_s, velocities[peak]->deg_s)
                                : centreOfPeak_s(peak, width_s, velocities);
    const double from_s = centre_s - half_s, until_s = centre_s + half_s;
    std::size_t i = peak;
    while (i > 0 && time_s(i - 1) >= from_s) --i;
    for (; i < sights_.size() && time_s(i) <= until_s + kWideOscillation_s; ++i) {
      if (time_s(i) < from_s || states_[i] != GazeState::fixation) continue;
      if (time_s(i) <= until_s || (few && isFastStep(i, velocities[peak]->deg_s, fast_deg_s))) {
        states_[i] = GazeState::saccade;
      } else if (few) {
        break;
      } else {
        states_[i] = GazeState::oscillation;
      }
    }
  }

  /// Whether gaze moves fast along `velocity_deg_s` from the sample before to this one.
  bool isFastStep(std::size_t i, const glm::dvec3& velocity_deg_s, double fast_deg_s) const {
    if (i == 0 || !sights_[i].direction || !sights_[i - 1].direction) return false;
    const glm::dvec3 step = *sights_[i].direction - *sights_[i - 1].direction;
    return glm::degrees(glm::dot(step, glm::normalize(velocity_deg_s))) >
           fast_deg_s * (time_s(i) - time_s(i - 1));
  }

  /// The centre of gravity of the peak's upper half.
  double centreOfPeak_s(std::size_t peak, double width_s, const Velocities& velocities) const {
    const double low_deg_s = 0.5 * velocities[peak]->speed_deg_s;
    double sum = 0.0, moment_s = 0.0;
    const auto add = [&](std::size_t i) {
      if (!velocities[i] || velocities[i]->speed_deg_s <= low_deg_s ||
          std::abs(time_s(i) - time_s(peak)) > width_s) {
        return false;
      }
      sum += velocities[i]->speed_deg_s - low_deg_s;
      moment_s += (velocities[i]->speed_deg_s - low_deg_s) * (time_s(i) - time_s(peak));
      return true;
    };
    for (std::size_t i = peak; i < sights_.size() && add(i); ++i) continue;
    for (std::size_t i = peak; i-- > 0 && add(i);) continue;
    return time_s(peak) + moment_s / sum;
  }

  /// The same for a slow tracker with few samples: the centre of gravity of the steps along the
  /// saccade. Small steps do not belong to the saccade.
  double centreOfSteps_s(std::size_t peak, double width_s, const glm::dvec3& velocity_deg_s) const {
    constexpr double kMinPart = 0.15;  // of the amplitude
    const glm::dvec3 along = glm::normalize(velocity_deg_s);
    const double min_step = kMinPart * glm::radians(glm::length(velocity_deg_s)) * width_s / 1.5;
    double sum = 0.0, moment_s = 0.0;
    for (std::size_t i = peak - std::min<std::size_t>(peak, 3); i + 1 < sights_.size(); ++i) {
      if (time_s(i) - time_s(peak) > width_s) break;
      if (time_s(peak) - time_s(i) > width_s || !sights_[i].direction ||
          !sights_[i + 1].direction) {
        continue;
      }
      const double step = glm::dot(*sights_[i + 1].direction - *sights_[i].direction, along);
      if (step < min_step) continue;
      sum += step;
      moment_s += step * (0.5 * (time_s(i) + time_s(i + 1)) - time_s(peak));
    }
    return sum > 0.0 ? time_s(peak) + moment_s / sum : time_s(peak);
  }

  /// Marks data loss and the motion beside it as blinks. A half-closed eyelid hides a part of the
  /// pupil, so that gaze seems to move.
  void markBlinks(const std::vector<bool>& blinks) {
    const auto isLost = [&](std::size_t i) { return !sights_[i].direction || blinks[i]; };
    const auto moves = [&](std::size_t i) {
      return states_[i] == GazeState::saccade || states_[i] == GazeState::oscillation;
    };
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      if (!isLost(i)) continue;
      std::size_t first = i, last = i;
      while (last + 1 < sights_.size() && isLost(last + 1)) ++last;
      const double from_s = time_s(first), to_s = time_s(last);
      for (std::size_t j = first; j-- > 0 && states_[j] != GazeState::blink &&
                                  from_s - time_s(j) <= kLidReach_s &&
                                  time_s(first) - time_s(j) <= rules_.lid_rest_s;) {
        if (moves(j)) first = j;
      }
      std::size_t end = last;
      for (std::size_t j = last + 1;
           j < sights_.size() && !isLost(j) && time_s(j) - to_s <= kLidReach_s &&
           time_s(j) - time_s(end) <= rules_.lid_rest_s;
           ++j) {
        if (moves(j)) end = j;
      }
      const bool lid = first < i || end > last || blinks[i];
      const bool bridged = !lid && to_s - from_s + 1.0 / rate_Hz_ <= settings_.max_gap_s && i > 0 &&
                           last + 1 < sights_.size() && states_[i - 1] == GazeState::fixation;
      if (!bridged) mark(first, end, GazeState::blink);
      i = last;
    }
  }

  std::span<const TimedSight> sights_;
  double rate_Hz_;
  const SightNoise& noise_;
  const EventSettings& settings_;
  const EventRules& rules_;
  std::vector<GazeState> states_;
};

}  // namespace

std::vector<GazeState> labelSaccades(std::span<const TimedSight> sights,
                                     const std::vector<bool>& blinks, double rate_Hz,
                                     const SightNoise& noise, const EventSettings& settings) {
  return SaccadeFinder(sights, rate_Hz, noise, settings).find(blinks);
}

std::vector<GazeState> labelByVelocity(std::span<const TimedSight> sights, double rate_Hz,
                                       double saccade_deg_s) {
  const auto velocities = velocitiesOfSight(sights, kVelocityWindow_s, longestStep_s(rate_Hz));
  std::vector<GazeState> states(sights.size(), GazeState::fixation);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (!sights[i].direction) {
      states[i] = GazeState::blink;
    } else if (velocities[i] && velocities[i]->speed_deg_s >= saccade_deg_s) {
      states[i] = GazeState::saccade;
    }
  }
  return states;
}

std::vector<GazeState> labelByDispersion(std::span<const TimedSight> sights) {
  constexpr double kDispersion_deg = 1.0, kSlack_s = 1e-6;
  std::vector<GazeState> states(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    states[i] = sights[i].direction ? GazeState::saccade : GazeState::blink;
  }
  std::size_t labelled = 0;  // samples before it have their label from an earlier window
  for (std::size_t first = 0; first < sights.size(); ++first) {
    glm::dvec2 least(INFINITY), most(-INFINITY);
    std::size_t end = first;
    for (; end < sights.size(); ++end) {
      const double since_s = sights[end].time_s - sights[first].time_s;
      if (since_s > kDispersionWindow_s + kSlack_s) break;
      if (!sights[end].direction) continue;
      const glm::dvec3& sight = *sights[end].direction;
      const glm::dvec2 angles_deg = glm::degrees(
          glm::dvec2(std::atan2(sight.x, -sight.z), std::asin(std::clamp(sight.y, -1.0, 1.0))));
      least = glm::min(least, angles_deg);
      most = glm::max(most, angles_deg);
    }
    const bool is_complete = end < sights.size() || sights[end - 1].time_s - sights[first].time_s >=
                                                        kDispersionWindow_s - kSlack_s;
    const glm::dvec2 extent_deg = most - least;
    if (!is_complete || !(extent_deg.x + extent_deg.y <= kDispersion_deg)) continue;
    for (std::size_t i = std::max(first, labelled); i < end; ++i) {
      if (sights[i].direction) states[i] = GazeState::fixation;
    }
    labelled = end;
  }
  return states;
}

}  // namespace foci
