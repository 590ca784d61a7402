// I-VT (Salvucci and Goldberg 2000) on the slope of a short window, with the gap, merge and
// duration rules of Tobii's filter (Olsen 2012).
#include "gaze/events/online_events.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "gaze/focus/line_of_sight.h"

namespace foci {
namespace {

bool isStable(GazeState state) {
  return state == GazeState::fixation || state == GazeState::pursuit;
}

TimedSight sightOf(const GazeSample& sample, const Screen& screen) {
  TimedSight sight{.time_s = sample.time_s};
  if (sample.point_px) sight.direction = lineOfSight(screen, *sample.point_px);
  return sight;
}

}  // namespace

OnlineEvents::OnlineEvents(const Screen& screen, double rate_Hz, const EventSettings& settings)
    : screen_(screen), rate_Hz_(rate_Hz), settings_(settings) {
  assert(rate_Hz > 0.0);
  constexpr double kRounding = 1e-6;  // of samples: a window of whole intervals keeps both its ends
  delay_ = static_cast<std::size_t>(0.5 * settings.window_s * rate_Hz + kRounding);
  reach_s_ = std::max(0.75 * settings.window_s, 1.5 / rate_Hz);
}

GazeNow OnlineEvents::push(const GazeSample& sample) {
  const std::size_t window = std::max<std::size_t>(2 * delay_ + 1, 2);
  if (samples_.size() == window) {
    samples_.erase(samples_.begin());
    sights_.erase(sights_.begin());
  }
  samples_.push_back(sample);
  sights_.push_back(sightOf(sample, screen_));

  // Until the first sample can be labelled, gaze counts as fixating.
  const bool early = samples_.size() <= delay_;
  const std::size_t labelled = samples_.size() - 1 - (early ? 0 : delay_);
  const GazeSample& subject = samples_[labelled];
  now_.state_time_s = subject.time_s;
  if (early) {
    now_.state = sample.point_px ? GazeState::fixation : GazeState::lost;
  } else {
    now_.state = stateIn(labelled);
    if (subject.point_px) last_present_s_ = subject.time_s;
  }
  if (!isStable(now_.state)) {
    fixation_.clear();
  } else if (subject.point_px) {
    fixate(subject);
  }
  return now_;
}

GazeState OnlineEvents::stateIn(std::size_t labelled) const {
  const GazeSample& subject = samples_[labelled];
  if (subject.blink) return GazeState::blink;
  if (!subject.point_px) {
    const double lost_s = last_present_s_ ? subject.time_s - *last_present_s_ : INFINITY;
    if (lost_s <= settings_.max_gap_s) return now_.state;
    return lost_s <= settings_.max_blink_s ? GazeState::blink : GazeState::lost;
  }
  std::size_t first = labelled, last = labelled;
  while (first > 0 && subject.time_s - samples_[first - 1].time_s <= reach_s_) --first;
  while (last + 1 < samples_.size() && samples_[last + 1].time_s - subject.time_s <= reach_s_) {
    ++last;
  }
  const auto speed = speedOfSight_deg_s(std::span(sights_).subspan(first, last - first + 1));
  return speed && *speed > settings_.saccade_deg_s ? GazeState::saccade : GazeState::fixation;
}

void OnlineEvents::fixate(const GazeSample& sample) {
  while (!fixation_.empty() && sample.time_s - fixation_.front().time_s > settings_.position_s) {
    fixation_.pop_front();
  }
  fixation_.push_back(sample);
  glm::dvec2 sum_px{0.0};
  for (const GazeSample& each : fixation_) sum_px += *each.point_px;
  now_.fixation_px = sum_px / static_cast<double>(fixation_.size());
}

std::vector<GazeState> labelSamples(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  OnlineEvents events(screen, trace.rate_Hz, settings);
  const std::size_t delay = events.delaySamples();
  std::vector<GazeState> states;
  states.reserve(trace.samples.size());
  // The end is followed by nothing, so that the last samples get their labels too.
  for (std::size_t i = 0; i < trace.samples.size() + delay; ++i) {
    const bool ended = i >= trace.samples.size();
    GazeSample sample = ended ? GazeSample{} : trace.samples[i];
    if (ended) {
      const auto beyond = static_cast<double>(i - trace.samples.size() + 1);
      sample.time_s = trace.samples.back().time_s + beyond / trace.rate_Hz;
    }
    const GazeState state = events.push(sample).state;
    if (i >= delay) states.push_back(state);
  }
  return states;
}

namespace {

/// A run of samples [first, last] with one label.
struct Run {
  GazeState state = GazeState::lost;
  std::size_t first = 0, last = 0;
};

class EventBuilder {
 public:
  EventBuilder(const GazeTrace& trace, const Screen& screen, const EventSettings& settings)
      : trace_(trace), screen_(screen), settings_(settings) {}

  std::vector<GazeEvent> build() {
    const auto states = labelSamples(trace_, screen_, settings_);
    std::vector<GazeEvent> events;
    for (const Run& run : mergedFixations(joinedSaccades(runsOf(states)))) {
      const double duration_s = durationOf(run);
      if (isStable(run.state) && duration_s < settings_.min_fixation_s) continue;
      events.push_back(eventOf(run, duration_s));
    }
    return events;
  }

 private:
  bool follows(std::size_t next) const {
    const double gap_s = trace_.samples[next].time_s - trace_.samples[next - 1].time_s;
    return gap_s <= std::max(settings_.max_gap_s, 1.5 / trace_.rate_Hz);
  }

  std::vector<Run> runsOf(const std::vector<GazeState>& states) const {
    std::vector<Run> runs;
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (runs.empty() || runs.back().state != states[i] || !follows(i)) {
        runs.push_back({states[i], i, i});
      }
      runs.back().last = i;
    }
    return runs;
  }

  /// When the run gives way to the next sample or, before a break in the recording, one interval
  /// on.
  double endOf(const Run& run) const {
    const std::size_t next = run.last + 1;
    if (next < trace_.samples.size() && follows(next)) return trace_.samples[next].time_s;
    return trace_.samples[run.last].time_s + 1.0 / trace_.rate_Hz;
  }

  double durationOf(const Run& run) const { return endOf(run) - trace_.samples[run.first].time_s; }

  std::optional<glm::dvec2> meanOf_px(const Run& run) const {
    glm::dvec2 mean{0.0};
    double count = 0.0;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      if (!trace_.samples[i].point_px) continue;
      count += 1.0;
      mean += (*trace_.samples[i].point_px - mean) / count;
    }
    return count > 0.0 ? std::optional(mean) : std::nullopt;
  }

  std::vector<Run> joinedSaccades(const std::vector<Run>& runs) const {
    std::vector<Run> joined;
    for (const Run& run : runs) {
      const std::size_t n = joined.size();
      if (run.state == GazeState::saccade && n >= 2 && joined[n - 2].state == GazeState::saccade &&
          isStable(joined[n - 1].state) && durationOf(joined[n - 1]) < settings_.oscillation_s &&
          follows(run.first) && follows(joined[n - 1].first)) {
        joined.pop_back();
        joined.back().last = run.last;
      } else {
        joined.push_back(run);
      }
    }
    return joined;
  }

  /// Joins fixations with little time and little distance between them; what lay between goes.
  std::vector<Run> mergedFixations(const std::vector<Run>& runs) const {
    std::vector<Run> merged;
    std::optional<std::size_t> before;  // the latest fixation in `merged`
    for (const Run& run : runs) {
      if (isStable(run.state) && before) {
        const Run& fixation = merged[*before];
        const double gap_s = trace_.samples[run.first].time_s - endOf(fixation);
        const auto a = meanOf_px(fixation), b = meanOf_px(run);
        if (gap_s < settings_.merge_gap_s && a && b &&
            angleBetween_deg(screen_, *a, *b) < settings_.merge_deg) {
          merged.resize(*before + 1);
          merged[*before].last = run.last;
          continue;
        }
      }
      if (isStable(run.state)) before = merged.size();
      merged.push_back(run);
    }
    return merged;
  }

  GazeEvent eventOf(const Run& run, double duration_s) const {
    GazeEvent event{
        .kind = run.state, .onset_s = trace_.samples[run.first].time_s, .duration_s = duration_s};
    if (isStable(run.state)) event.position_px = meanOf_px(run);
    if (run.state != GazeState::saccade) return event;

    // A saccade starts at the last sample of what was before it.
    std::size_t first = run.first > 0 && follows(run.first) ? run.first - 1 : run.first;
    while (first < run.last && !trace_.samples[first].point_px) ++first;
    std::size_t last = run.last;
    while (last > first && !trace_.samples[last].point_px) --last;
    event.start_px = trace_.samples[first].point_px;
    event.position_px = trace_.samples[last].point_px;
    if (event.start_px && event.position_px) {
      event.amplitude_deg = angleBetween_deg(screen_, *event.start_px, *event.position_px);
    }
    event.peak_velocity_deg_s = peakSpeed_deg_s(first, last);
    return event;
  }

  /// Over windows of 8 ms, or of two samples: the detector's own would flatten the peak.
  double peakSpeed_deg_s(std::size_t first, std::size_t last) const {
    constexpr double kWindow_s = 0.008;
    const auto span = static_cast<std::size_t>(std::lround(kWindow_s * trace_.rate_Hz));
    const std::size_t length = std::min(std::max<std::size_t>(span + 1, 2), last - first + 1);
    std::vector<TimedSight> sights;
    double peak = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      sights.push_back(sightOf(trace_.samples[i], screen_));
      if (sights.size() < length) continue;
      const auto window = std::span(sights).last(length);
      peak = std::max(peak, speedOfSight_deg_s(window).value_or(0.0));
    }
    return peak;
  }

  const GazeTrace& trace_;
  const Screen& screen_;
  const EventSettings& settings_;
};

}  // namespace

std::vector<GazeEvent> detectEvents(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  return EventBuilder(trace, screen, settings).build();
}

}  // namespace foci
