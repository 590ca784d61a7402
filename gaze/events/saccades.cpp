// After Nystrom and Holmqvist (2010): peak and edge thresholds from the noise, glissades after
// saccades. The noise is measured as by Engbert and Kliegl (2003), but on changes of velocity. All
// constants without a source were fitted to the coders of 21 recordings (gaze.md), with white noise
// of up to a degree added and at 30 to 1000 Hz.
#include "gaze/events/saccades.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

using Velocities = std::vector<std::optional<SightVelocity>>;

constexpr double kPeakNoise = 8.5;    // of a saccade's peak, in standard deviations of the noise
constexpr double kEdge_deg_s = 22.0;  // of its ends, at least
constexpr double kEdgeNoise = 5.0;
constexpr double kShortest_s = 0.0045;  // of a saccade above the edges' threshold
constexpr double kRestNoise = 4.0;      // what still moves after a saccade
constexpr double kRest_deg_s = 6.0;
constexpr double kRest_s = 0.008;        // still for so long: the oscillation is over
constexpr double kOscillation_s = 0.02;  // its longest
constexpr double kEcho_s = 0.02;         // a motion so soon after a saccade and so much smaller
constexpr double kEchoRatio = 0.6;       // is its oscillation, too
constexpr std::size_t kScales = 5;
constexpr double kLongestWindow_s = 0.25;
constexpr double kWide_s = 0.022;            // a longer window is longer than most saccades
constexpr double kBlurredPeak_deg_s = 90.0;  // a threshold that leaves out most small saccades,
constexpr double kClearPeak_deg_s = 95.0;    // and one that a window twice as long must get down to
constexpr double kHiddenNoise = 5.0;         // noise hides a saccade that a wider window may show
constexpr double kWhite = 1.4;          // the noise must fall with the window as white noise does
constexpr double kWhiteAndSteps = 2.0;  // so where each window may hold a saccade
constexpr double kWidePeak_deg_s = 20.0;
constexpr double kWideNoise = 4.5;
constexpr double kApart = 0.2;  // of a window, between a wide saccade and another
constexpr double kDuration_s = 0.021, kDurationPerDegree_s = 0.0022;  // Carpenter (1988)
constexpr double kWideOscillation_s = 0.02;                           // what a typical one takes
constexpr double kLidReach_s = 0.3;  // motion so far from a loss may be the lid's
constexpr double kLidRest_s = 0.04;  // unless gaze rests in between

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(glm::distance(a, b));
}

/// Samples in a window of this length.
double samplesIn(double window_s, double rate_Hz) {
  return 2.0 * std::floor(0.5 * window_s * rate_Hz + 1e-3) + 1.0;
}

std::size_t stepOf(double window_s, double rate_Hz) {
  return static_cast<std::size_t>(window_s * rate_Hz + 1.01);
}

class SaccadeFinder {
 public:
  SaccadeFinder(std::span<const TimedSight> sights, double rate_Hz, const SightNoise& noise,
                const EventSettings& settings)
      : sights_(sights),
        rate_Hz_(rate_Hz),
        noise_(noise),
        settings_(settings),
        states_(sights.size(), GazeState::fixation) {}

  std::vector<GazeState> find(const std::vector<bool>& blinks) {
    const bool narrow = window_s(0) <= kWide_s;
    const std::size_t finest = narrow && noiseBlursNarrow() ? 1 : 0;
    if (narrow) findNarrow(finest);
    bool hidden = narrow && kHiddenNoise * noise_.velocity_deg_s[finest] > settings_.saccade_deg_s;
    for (std::size_t scale = narrow ? finest + 1 : 0; scale < kScales; ++scale) {
      if (scale > 0 && (!hidden || window_s(scale) > kLongestWindow_s || !isWhite(scale))) break;
      const double floor_deg_s = scale == 0 ? settings_.saccade_deg_s : kWidePeak_deg_s;
      findWide(scale, floor_deg_s);
      hidden = kHiddenNoise * noise_.velocity_deg_s[scale] > kWidePeak_deg_s;
    }
    markBlinks(blinks);
    return std::move(states_);
  }

 private:
  double window_s(std::size_t scale) const { return scaleWindow_s(scale, rate_Hz_, settings_); }
  double time_s(std::size_t i) const { return sights_[i].time_s; }

  bool isWhite(std::size_t scale) const {
    const double n = samplesIn(window_s(scale), rate_Hz_);
    const double before = samplesIn(window_s(scale - 1), rate_Hz_);
    const double falls = std::sqrt(before * (before * before - 1.0) / (n * (n * n - 1.0)));
    const double white = window_s(0) > kWide_s ? kWhiteAndSteps : kWhite;
    return noise_.velocity_deg_s[scale] <= white * falls * noise_.velocity_deg_s[scale - 1];
  }

  /// Of the two windows that are shorter than most saccades, the shorter shows edges best, but only
  /// where the noise lets it see them.
  bool noiseBlursNarrow() const {
    return window_s(1) <= kWide_s + 1e-6 &&
           kPeakNoise * noise_.velocity_deg_s[0] > kBlurredPeak_deg_s &&
           kPeakNoise * noise_.velocity_deg_s[1] <= kClearPeak_deg_s;
  }

  void mark(std::size_t first, std::size_t last, GazeState state) {
    std::fill(states_.begin() + static_cast<std::ptrdiff_t>(first),
              states_.begin() + static_cast<std::ptrdiff_t>(last + 1), state);
  }

  void findNarrow(std::size_t scale) {
    const double sigma_deg_s = noise_.velocity_deg_s[scale];
    const double peak_deg_s = std::max(settings_.saccade_deg_s, kPeakNoise * sigma_deg_s);
    const double edge_deg_s = std::min(std::max(kEdge_deg_s, kEdgeNoise * sigma_deg_s), peak_deg_s);
    const double rest_deg_s = std::max(kRest_deg_s, kRestNoise * sigma_deg_s);
    const auto shortest = static_cast<std::size_t>(kShortest_s * rate_Hz_);
    const Velocities velocities =
        velocitiesOfSight(sights_, window_s(scale), longestStep_s(rate_Hz_));
    const auto speed_deg_s = [&](std::size_t i) {
      return velocities[i] ? velocities[i]->speed_deg_s : 0.0;
    };

    std::optional<std::size_t> end;  // of the latest saccade and its oscillation
    double amplitude_deg = 0.0;      // of the saccade
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      if (speed_deg_s(i) <= peak_deg_s) continue;
      std::size_t peak = i;
      for (std::size_t j = i + 1; j < sights_.size() && speed_deg_s(j) > edge_deg_s; ++j) {
        if (speed_deg_s(j) > speed_deg_s(peak)) {
          peak = j;
        } else if (glm::dot(velocities[j]->deg_s, velocities[peak]->deg_s) <=
                   edge_deg_s * speed_deg_s(peak)) {
          break;
        }
      }
      const glm::dvec3 along = velocities[peak]->deg_s / speed_deg_s(peak);
      std::size_t first = peak, last = peak;
      while (first > (end ? *end + 1 : 0) && speed_deg_s(first - 1) > edge_deg_s) --first;
      while (last + 1 < sights_.size() && velocities[last + 1] &&
             glm::dot(velocities[last + 1]->deg_s, along) > edge_deg_s) {
        ++last;
      }

      const double moved_deg = angle_deg(*sights_[first].direction, *sights_[last].direction);
      if (end && time_s(first) - time_s(*end) <= kEcho_s &&
          moved_deg < kEchoRatio * amplitude_deg) {
        mark(*end + 1, last, GazeState::oscillation);
      } else if (last - first + 1 >= shortest) {
        mark(first, last, GazeState::saccade);
        amplitude_deg = moved_deg;
      } else {
        i = last;
        continue;
      }

      end = last;
      for (std::size_t j = last + 1;
           j < sights_.size() && velocities[j] && speed_deg_s(j) <= peak_deg_s &&
           time_s(j) - time_s(*end) <= kRest_s && time_s(j) - time_s(last) <= kOscillation_s;
           ++j) {
        if (speed_deg_s(j) > rest_deg_s) end = j;
      }
      if (*end > last) mark(last + 1, *end, GazeState::oscillation);
      i = *end;
    }
  }

  void findWide(std::size_t scale, double floor_deg_s) {
    const double width_s = window_s(scale);
    const Velocities velocities = velocitiesOfSight(sights_, width_s, longestStep_s(rate_Hz_));
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      const auto& at = velocities[i];
      if (at && at->speed_deg_s > std::max(floor_deg_s, kWideNoise * at->noise_gain *
                                                            noise_.velocity_deg_s[scale])) {
        candidates.push_back(i);
      }
    }
    std::sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
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
      markTypical(peak, width_s, velocities, scale == 0);
    }
  }

  /// A saccade as long as its amplitude lets expect. The slope over a window T of a step A peaks
  /// at 1.5 A / T.
  void markTypical(std::size_t peak, double width_s, const Velocities& velocities, bool few) {
    const double amplitude_deg = velocities[peak]->speed_deg_s * width_s / 1.5;
    const double half_s = 0.5 * (kDuration_s + kDurationPerDegree_s * amplitude_deg);
    const double centre_s = few ? centreOfSteps_s(peak, width_s, velocities[peak]->deg_s)
                                : centreOfPeak_s(peak, width_s, velocities);
    const double from_s = centre_s - half_s, until_s = centre_s + half_s;
    std::size_t i = peak;
    while (i > 0 && time_s(i - 1) >= from_s) --i;
    for (; i < sights_.size() && time_s(i) <= until_s + kWideOscillation_s; ++i) {
      if (time_s(i) < from_s || states_[i] != GazeState::fixation) continue;
      states_[i] = time_s(i) > until_s ? GazeState::oscillation : GazeState::saccade;
    }
  }

  /// The middle of the part of the peak above half of its height.
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

  /// The same from the few samples of a slow tracker: each step along the saccade lies half-way
  /// between its samples; small ones are no part of it.
  double centreOfSteps_s(std::size_t peak, double width_s, const glm::dvec3& velocity_deg_s) const {
    constexpr double kPart = 0.15;
    const glm::dvec3 along = glm::normalize(velocity_deg_s);
    const double least = kPart * glm::radians(glm::length(velocity_deg_s)) * width_s / 1.5;
    double sum = 0.0, moment_s = 0.0;
    for (std::size_t i = peak - std::min<std::size_t>(peak, 3); i + 1 < sights_.size(); ++i) {
      if (time_s(i) - time_s(peak) > width_s) break;
      if (time_s(peak) - time_s(i) > width_s || !sights_[i].direction ||
          !sights_[i + 1].direction) {
        continue;
      }
      const double step = glm::dot(*sights_[i + 1].direction - *sights_[i].direction, along);
      if (step < least) continue;
      sum += step;
      moment_s += step * (0.5 * (time_s(i) + time_s(i + 1)) - time_s(peak));
    }
    return sum > 0.0 ? time_s(peak) + moment_s / sum : time_s(peak);
  }

  /// Losses, and the motion next to them: half-closed lids hide a part of the pupil.
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
                                  time_s(first) - time_s(j) <= kLidRest_s;) {
        if (moves(j)) first = j;
      }
      std::size_t end = last;
      for (std::size_t j = last + 1;
           j < sights_.size() && !isLost(j) && time_s(j) - to_s <= kLidReach_s &&
           time_s(j) - time_s(end) <= kLidRest_s;
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
  std::vector<GazeState> states_;
};

}  // namespace

double longestStep_s(double rate_Hz) { return 2.5 / rate_Hz; }

double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings) {
  return std::max(settings.window_s, 2.0 / rate_Hz) * std::exp2(static_cast<double>(scale));
}

SightNoise noiseOf(std::span<const TimedSight> sights, double rate_Hz,
                   const EventSettings& settings) {
  SightNoise noise;
  const auto measured_deg_s = [&](double window_s) {
    return velocityNoise_deg_s(velocitiesOfSight(sights, window_s, longestStep_s(rate_Hz)),
                               stepOf(window_s, rate_Hz));
  };
  // The slope over three samples is half the difference of the outer two.
  noise.sample_deg = measured_deg_s(2.0 / rate_Hz) * std::sqrt(2.0) / rate_Hz;
  for (std::size_t scale = 0; scale < kScales; ++scale) {
    const double window_s = scaleWindow_s(scale, rate_Hz, settings);
    noise.velocity_deg_s.push_back(scale == 0 || window_s <= kLongestWindow_s
                                       ? measured_deg_s(window_s)
                                       : noise.velocity_deg_s.back());
  }
  return noise;
}

std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise) {
  constexpr double kLongest_s = 0.025;
  constexpr double kSlowest_Hz = 60.0;  // one sample may be a glance
  constexpr double kLeast_deg = 0.5, kNoise = 8.0;
  constexpr double kReturns = 4.0;  // times as far out as its neighbours lie apart
  std::vector<TimedSight> result(sights.begin(), sights.end());
  if (rate_Hz < kSlowest_Hz) return result;
  const double min_deg = std::max(kLeast_deg, kNoise * noise.sample_deg);
  for (std::size_t i = 1; i < result.size(); ++i) {
    for (std::size_t length : {1, 2, 3}) {
      const std::size_t next = i + length;
      if (next >= result.size() || static_cast<double>(length + 1) > kLongest_s * rate_Hz) break;
      if (!result[i - 1].direction || !result[next].direction) continue;
      const glm::dvec3 from = *result[i - 1].direction, to = *result[next].direction;
      double out_deg = 180.0;
      for (std::size_t j = i; j < next; ++j) {
        if (!result[j].direction)
          out_deg = 0.0;
        else
          out_deg = std::min(out_deg, angle_deg(*result[j].direction, 0.5 * (from + to)));
      }
      if (out_deg <= min_deg || out_deg <= kReturns * angle_deg(from, to)) continue;
      for (std::size_t j = i; j < next; ++j) {
        const double part = static_cast<double>(j + 1 - i) / static_cast<double>(length + 1);
        result[j].direction = glm::normalize(glm::mix(from, to, part));
      }
    }
  }
  return result;
}

std::vector<GazeState> labelSaccades(std::span<const TimedSight> sights,
                                     const std::vector<bool>& blinks, double rate_Hz,
                                     const SightNoise& noise, const EventSettings& settings) {
  return SaccadeFinder(sights, rate_Hz, noise, settings).find(blinks);
}

}  // namespace foci
