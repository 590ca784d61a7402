// The constants were fitted together with those of saccades.cpp, on the same labelled recordings.
#include "gaze/events/sight_noise.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(glm::distance(a, b));
}

/// Samples from a window to the next one that does not overlap it.
std::size_t stepOf(double window_s, double rate_Hz) {
  return static_cast<std::size_t>(window_s * rate_Hz + 1.01);
}

}  // namespace

double longestStep_s(double rate_Hz) { return 2.5 / rate_Hz; }

double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings) {
  return std::max(settings.window_s, 2.0 / rate_Hz) * std::exp2(static_cast<double>(scale));
}

bool mayHideSaccades(double noise_deg_s, std::size_t scale, double rate_Hz,
                     const EventSettings& settings) {
  const SaccadeRules& rules = settings.rules;
  const bool narrow = scale == 0 && scaleWindow_s(0, rate_Hz, settings) <= kWide_s;
  return rules.hidden_noise * noise_deg_s > (narrow ? settings.saccade_deg_s : kWidePeak_deg_s) ||
         (narrow && rules.peak_noise * noise_deg_s > kBlurredPeak_deg_s);
}

SightNoise noiseOf(std::span<const TimedSight> sights, double rate_Hz,
                   const EventSettings& settings) {
  SightNoise noise;
  const auto measured_deg_s = [&](double window_s, double errors) {
    return velocityNoise_deg_s(velocitiesOfSight(sights, window_s, longestStep_s(rate_Hz)),
                               stepOf(window_s, rate_Hz), errors);
  };
  // The slope over three samples is half the difference of the outer two, divided by the interval.
  noise.sample_deg = measured_deg_s(2.0 / rate_Hz, 0.0) * std::sqrt(2.0) / rate_Hz;
  bool wider = true;
  for (std::size_t scale = 0; scale < kNoiseScales; ++scale) {
    const double window_s = scaleWindow_s(scale, rate_Hz, settings);
    wider = wider && (scale == 0 ||
                      (window_s <= kMaxNoiseWindow_s &&
                       mayHideSaccades(noise.velocity_deg_s.back(), scale - 1, rate_Hz, settings)));
    noise.velocity_deg_s.push_back(wider ? measured_deg_s(window_s, settings.rules.noise_errors)
                                         : noise.velocity_deg_s.back());
  }
  return noise;
}

bool RecentNoise::update(std::span<const TimedSight> sights) {
  constexpr double kAgain_s = 0.25;  // the noise changes slowly
  const double time_s = sights.back().time_s;
  if (noise_.velocity_deg_s.empty()) {
    begin_s_ = sights.front().time_s;
  } else if (time_s - measured_s_ < std::min(kAgain_s, 0.3 * (time_s - begin_s_))) {
    return false;
  }
  measured_s_ = time_s;
  const auto span = static_cast<std::size_t>(settings_.rules.noise_span_s * rate_Hz_);
  noise_ = noiseOf(sights.last(std::min(span, sights.size())), rate_Hz_, settings_);
  return true;
}

std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise) {
  constexpr double kMaxSpike_s = 0.025;
  constexpr double kMinRate_Hz = 60.0;  // at lower rates one sample may be a fixation
  constexpr double kMinSpike_deg = 0.5, kMinSpikeNoise = 8.0;
  constexpr double kReturns =
      4.0;  // a spike is this much farther than the step between its neighbours
  std::vector<TimedSight> result(sights.begin(), sights.end());
  if (rate_Hz < kMinRate_Hz) return result;
  const double min_deg = std::max(kMinSpike_deg, kMinSpikeNoise * noise.sample_deg);
  // From its neighbour before, a spike is at least this part of its own size away.
  const double min_step_deg = (1.0 - 0.5 / kReturns) * min_deg;
  for (std::size_t i = 1; i < result.size(); ++i) {
    if (!result[i].direction || !result[i - 1].direction ||
        angle_deg(*result[i].direction, *result[i - 1].direction) <= min_step_deg) {
      continue;
    }
    for (std::size_t length : {1, 2, 3}) {
      const std::size_t next = i + length;
      if (next >= result.size() || static_cast<double>(length + 1) > kMaxSpike_s * rate_Hz) break;
      if (!result[next].direction) continue;
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

}  // namespace foci
