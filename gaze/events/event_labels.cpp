#include "gaze/events/event_labels.h"

#include <algorithm>

#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/events/published_detectors.h"
#include "gaze/geometry/sampling_rate.h"

namespace foci {
namespace {

constexpr const char* kRulesVersion = "1";

/// A sample without gaze is a blink for these detectors, and data loss if it lasts.
void tellLoss(const GazeTrace& trace, double max_blink_s, std::vector<GazeState>& states) {
  const auto isMissing = [&](std::size_t i) {
    return !trace.samples[i].point_px && !trace.samples[i].blink;
  };
  for (std::size_t i = 0; i < states.size();) {
    std::size_t end = i + 1;
    if (isMissing(i)) {
      while (end < states.size() && isMissing(end)) ++end;
      if (trace.samples[end - 1].time_s - trace.samples[i].time_s > max_blink_s) {
        std::fill(states.begin() + static_cast<std::ptrdiff_t>(i),
                  states.begin() + static_cast<std::ptrdiff_t>(end), GazeState::lost);
      }
    }
    i = end;
  }
}

std::vector<GazeState> labelPublished(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings) {
  std::vector<TimedSight> sights;
  for (const GazeSample& sample : trace.samples) sights.push_back(sightOf(sample, screen));
  auto states = settings.detector == Detector::ivt
                    ? labelByVelocity(sights, trace.rate_Hz, settings.saccade_deg_s)
                    : labelByDispersion(sights);
  tellLoss(trace, settings.max_blink_s, states);
  return states;
}

/// The online detector's states, with the delay compensated.
std::vector<GazeState> followStates(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  OnlineEvents events(screen, trace.rate_Hz, settings);
  const std::size_t delay = events.delaySamples();
  std::vector<GazeState> states;
  states.reserve(trace.samples.size());
  // Push empty samples behind the end, so that the last samples get their labels too.
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

void add(const std::vector<SampleLabel>& found, EventLabels& labels) {
  for (const SampleLabel& label : found) {
    labels.states.push_back(label.state);
    labels.probabilities.push_back(label.probabilities);
  }
}

}  // namespace

std::string versionOf(Detector detector) {
  return detector == Detector::trained ? std::to_string(builtinEventModel().revision)
                                       : kRulesVersion;
}

std::string labelOf(Detector detector) {
  return std::string(nameOf(detector)) + ' ' + versionOf(detector);
}

bool judgesPursuit(const GazeTrace& trace, const EventSettings& settings) {
  if (settings.pursuit) return *settings.pursuit;
  return !trace.field || std::any_of(trace.samples.begin(), trace.samples.end(),
                                     [](const GazeSample& sample) { return sample.head; });
}

namespace {

/// Adds the labels of a stretch with one rate.
void label(const GazeTrace& trace, const Screen& screen, const EventSettings& settings, bool online,
           EventLabels& labels) {
  const std::size_t first = labels.states.size();
  if (settings.detector == Detector::trained) {
    add((online ? labelTrainedOnline : labelTrained)(trace, screen, settings, builtinEventModel(),
                                                     {}),
        labels);
  } else {
    const auto states = online ? followStates(trace, screen, settings)
                        : settings.detector == Detector::rules
                            ? labelByRules(trace, screen, settings)
                            : labelPublished(trace, screen, settings);
    labels.states.insert(labels.states.end(), states.begin(), states.end());
  }
  const auto in_hindsight = signalDoubts(trace, screen, settings, kWholeRecording);
  const auto doubts =
      online ? signalDoubts(trace, screen, settings, settings.delay_s) : in_hindsight;
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    GazeState& state = labels.states[first + i];
    if (state == GazeState::pursuit && !*settings.pursuit) state = GazeState::fixation;
    if (in_hindsight[i] == SignalDoubt::none && state != GazeState::lost) labels.any_judged = true;
    if (doubts[i] == SignalDoubt::none) continue;
    labels.unjudged_s[static_cast<std::size_t>(doubts[i])] += 1.0 / trace.rate_Hz;
    if (settings.detector == Detector::rules) continue;
    state = GazeState::unjudged;
    if (labels.probabilities.empty()) continue;
    labels.probabilities[first + i] = {};
    labels.probabilities[first + i][static_cast<std::size_t>(GazeState::unjudged)] = 1.0;
  }
}

}  // namespace

EventLabels labelEvents(const GazeTrace& trace, const Screen& screen, const EventSettings& settings,
                        bool online) {
  EventSettings used = settings;
  used.pursuit = judgesPursuit(trace, settings);
  EventLabels labels;
  const auto rates = rateStretchesOf(trace);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    label(rates.size() == 1 ? trace : stretchOf(trace, rates, i), screen, used, online, labels);
  }
  labels.warnings = doubtWarnings(labels.unjudged_s, used.detector);
  return labels;
}

std::vector<GazeEvent> eventsOf(const EventLabels& labels, const GazeTrace& trace,
                                const Screen& screen, const EventSettings& settings) {
  std::vector<GazeEvent> events = eventsOf(labels.states, trace, screen, settings);
  if (labels.probabilities.empty()) return events;
  std::size_t i = 0;
  for (GazeEvent& event : events) {
    constexpr double kSlack_s = 1e-9;
    while (i < trace.samples.size() && trace.samples[i].time_s < event.onset_s - kSlack_s) ++i;
    double sum = 0.0, count = 0.0;
    for (; i < trace.samples.size() &&
           trace.samples[i].time_s < event.onset_s + event.duration_s - kSlack_s;
         ++i) {
      sum += labels.probabilities[i][static_cast<std::size_t>(event.kind)];
      count += 1.0;
    }
    if (count > 0.0) event.probability = sum / count;
  }
  return events;
}

std::vector<GazeEvent> detectEvents(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  return eventsOf(labelEvents(trace, screen, settings), trace, screen, settings);
}

std::vector<GazeState> labelSamples(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  return labelEvents(trace, screen, settings).states;
}

std::vector<GazeState> labelSamplesOnline(const GazeTrace& trace, const Screen& screen,
                                          const EventSettings& settings) {
  return labelEvents(trace, screen, settings, true).states;
}

}  // namespace foci
