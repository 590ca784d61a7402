#include "gaze/events/recording_quality.h"

#include <algorithm>
#include <cmath>

#include "base/quantile.h"
#include "base/text.h"
#include "gaze/events/event_model.h"
#include "gaze/events/gaze_speed.h"
#include "gaze/events/online_events.h"

namespace foci {
namespace {

/// Standard deviation of the intervals that are no gaps, and the longest time without gaze.
void measureTimes(const GazeTrace& trace, RecordingQuality& quality) {
  double count = 0.0, sum_s = 0.0, squares_s2 = 0.0, present = 0.0;
  const double nominal_s = 1.0 / trace.rate_Hz;
  double gaze_until_s = trace.samples.empty() ? 0.0 : trace.samples.front().time_s;
  const auto noteGap = [&](double now_s) {
    const double gap_s = now_s - gaze_until_s;
    if (gap_s > 0.5 * nominal_s) quality.longest_gap_s = std::max(quality.longest_gap_s, gap_s);
    gaze_until_s = now_s + nominal_s;
  };
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    const GazeSample& sample = trace.samples[i];
    if (i > 0) {
      const double off_s = sample.time_s - trace.samples[i - 1].time_s - nominal_s;
      if (off_s < 0.5 * nominal_s) {
        count += 1.0;
        sum_s += off_s;
        squares_s2 += off_s * off_s;
      }
    }
    if (!sample.point_px) continue;
    present += 1.0;
    noteGap(sample.time_s);
  }
  if (!trace.samples.empty()) noteGap(trace.samples.back().time_s + nominal_s);
  if (count > 0.0) {
    quality.jitter_s = std::sqrt(std::max(squares_s2 / count - std::pow(sum_s / count, 2), 0.0));
  }
  quality.lost =
      1.0 - present / static_cast<double>(std::max<std::size_t>(trace.samples.size(), 1));
}

/// Noise within runs of fixation samples.
void measureNoise(const GazeTrace& trace, const Screen& screen,
                  const std::vector<GazeState>& states, RecordingQuality& quality) {
  constexpr double kMinSamples = 5.0;
  double steps = 0.0, squared_steps = 0.0;
  std::vector<double> spreads_deg;
  double count = 0.0, squares = 0.0;
  glm::dvec3 sum{0.0}, origin{0.0};
  std::optional<glm::dvec3> last;
  const auto close = [&] {
    if (count >= kMinSamples) {
      const glm::dvec3 mean = sum / count;
      spreads_deg.push_back(
          glm::degrees(std::sqrt(std::max(squares / count - glm::dot(mean, mean), 0.0))));
    }
    count = squares = 0.0;
    sum = glm::dvec3(0.0);
    last.reset();
  };
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool paused = i > 0 && trace.samples[i].time_s - trace.samples[i - 1].time_s >=
                                     longestStep_s(trace.rate_Hz);
    if (paused) close();
    const auto sight = sightOf(trace.samples[i], screen).direction;
    if (states[i] != GazeState::fixation || !sight) {
      close();
      continue;
    }
    if (last) {
      steps += 1.0;
      squared_steps += glm::dot(*sight - *last, *sight - *last);
    } else {
      origin = *sight;
    }
    count += 1.0;
    sum += *sight - origin;
    squares += glm::dot(*sight - origin, *sight - origin);
    last = sight;
  }
  close();
  if (steps > 0.0) quality.rms_s2s_deg = glm::degrees(std::sqrt(squared_steps / steps));
  if (!spreads_deg.empty()) quality.sd_deg = quantile(spreads_deg, 0.5);
}

std::optional<MainSequence> fitMainSequence(const std::vector<GazeEvent>& events) {
  constexpr int kMinSaccades = 5;
  MainSequence fit;
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const GazeEvent& event : events) {
    if (!(event.amplitude_deg > 0.0) || !(event.peak_velocity_deg_s > 0.0)) continue;
    const double x = std::log(*event.amplitude_deg), y = std::log(*event.peak_velocity_deg_s);
    ++fit.saccades;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double n = fit.saccades, spread = n * sxx - sx * sx;
  if (fit.saccades < kMinSaccades || !(spread > 1e-9)) return std::nullopt;
  fit.exponent = (n * sxy - sx * sy) / spread;
  fit.at_1_deg_deg_s = std::exp((sy - fit.exponent * sx) / n);
  return fit;
}

}  // namespace

RecordingQuality qualityOf(const GazeTrace& trace, const Screen& screen,
                           const std::vector<GazeState>& states,
                           const std::vector<GazeEvent>& events) {
  RecordingQuality quality{.rate_Hz = trace.rate_Hz};
  measureTimes(trace, quality);
  if (!trace.relative) measureNoise(trace, screen, states, quality);
  quality.unjudged = static_cast<double>(std::ranges::count(states, GazeState::unjudged)) /
                     static_cast<double>(std::max<std::size_t>(states.size(), 1));
  quality.main_sequence = fitMainSequence(events);
  return quality;
}

std::vector<std::string> rangeWarnings(const RecordingQuality& quality,
                                       const EventSettings& settings) {
  std::vector<std::string> warnings;
  if (settings.detector != Detector::trained) return warnings;
  const EventModel& model = builtinEventModel();
  const auto warn = [&](const char* what, double value, const ModelRange& range, const char* unit) {
    constexpr double kSlack = 1.02;  // a rate that is measured is not exact
    const bool low = value * kSlack < range.least;
    if (!low && value <= range.greatest * kSlack) return;
    warnings.push_back(std::string("events: ") + what + ' ' + decimal(value, 3) + ' ' + unit +
                       (low ? ", trained from " : ", trained up to ") +
                       decimal(low ? range.least : range.greatest, 3) + ' ' + unit +
                       ": labels are less certain");
  };
  warn("rate", quality.rate_Hz, model.rate_Hz, "Hz");
  // A step between two samples has the noise of both, along each of two axes.
  if (quality.rms_s2s_deg) warn("noise", 0.5 * *quality.rms_s2s_deg, model.noise_deg, "deg");
  return warnings;
}

std::vector<std::string> eventWarnings(const GazeTrace& trace, const EventLabels& labels,
                                       const RecordingQuality& quality,
                                       const EventSettings& settings) {
  std::vector<std::string> warnings = labels.warnings;
  const auto of_range = rangeWarnings(quality, settings);
  warnings.insert(warnings.end(), of_range.begin(), of_range.end());
  const bool headless = trace.field && std::ranges::none_of(trace.samples, [](const auto& sample) {
                          return sample.head.has_value();
                        });
  if (headless) {
    warnings.push_back(
        judgesPursuit(trace, settings)
            ? "events: there are no head poses, so turns of the head count as pursuit"
            : "events: there are no head poses, and turns of the head look like "
              "pursuit: pursuit counts as fixation unless gaze.pursuit = true");
  }
  return warnings;
}

}  // namespace foci
