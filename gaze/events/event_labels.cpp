#include "gaze/events/event_labels.h"

#include "base/text.h"
#include "gaze/events/online_events.h"
#include "gaze/events/saccades.h"
#include "gaze/geometry/line_of_sight.h"
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
        std::ranges::fill(std::span(states).subspan(i, end - i), GazeState::lost);
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

constexpr double kMinRate_Hz = 25.0;
constexpr double kFrozen_s = 1.0;
constexpr double kLossSpan_s = 1.0, kMaxLoss = 0.5;
/// A window that holds a few fixations.
constexpr double kNoiseSpan_s = 3.0;
/// Along each axis. Two samples of such noise differ by twice as much, and so by more than many
/// saccades.
constexpr double kMinNoise_deg = 2.0;
/// The mean squared step divided by the variance is 2 for white noise (von Neumann 1941), and near
/// 0 for gaze. Above this, noise is more than half of the variance.
constexpr double kWhiteRatio = 1.0;

/// Sums over the samples before each one.
struct Sums {
  double steps = 0.0, squared_steps = 0.0, present = 0.0, squares = 0.0;
  glm::dvec3 positions{0.0};
};

class DoubtFinder {
 public:
  DoubtFinder(const GazeTrace& trace, const Screen& screen, const EventSettings& settings,
              double ahead_s)
      : samples_(trace.samples),
        settings_(settings),
        rate_Hz_(trace.rate_Hz),
        ahead_s_(ahead_s),
        is_simulated_(trace.simulated) {
    findLongLosses();
    sum(screen);
  }

  std::vector<SignalDoubt> find() const {
    const std::size_t count = samples_.size();
    std::vector<SignalDoubt> doubts(count, SignalDoubt::none);
    if (rate_Hz_ < kMinRate_Hz) {
      for (std::size_t i = 0; i < count; ++i) {
        if (!in_long_loss_[i]) doubts[i] = SignalDoubt::slow;
      }
      return doubts;
    }
    Window losses(kLossSpan_s, ahead_s_), noise(kNoiseSpan_s, ahead_s_);
    for (std::size_t i = 0; i < count; ++i) {
      losses.moveTo(i, samples_);
      noise.moveTo(i, samples_);
      if (in_long_loss_[i]) continue;
      if (isWhite(noise)) doubts[i] = SignalDoubt::white;
      if (isMostlyLost(losses, i)) doubts[i] = SignalDoubt::lost;
    }
    if (!is_simulated_) markFrozen(doubts);
    return doubts;
  }

 private:
  /// The samples [first, end) of a span around a sample, or before it if later ones are unknown.
  struct Window {
    Window(double span_s, double ahead_s)
        : after_s(std::min(ahead_s, 0.5 * span_s)), before_s(span_s - after_s) {}

    void moveTo(std::size_t i, const std::vector<GazeSample>& samples) {
      constexpr double kSlack_s = 1e-6;
      const double now_s = samples[i].time_s;
      while (samples[first].time_s < now_s - before_s - kSlack_s) ++first;
      while (end < samples.size() && samples[end].time_s <= now_s + after_s + kSlack_s) ++end;
    }
    double after_s, before_s;
    std::size_t first = 0, end = 0;
  };

  void findLongLosses() {
    in_long_loss_.assign(samples_.size(), false);
    for (std::size_t i = 0; i < samples_.size();) {
      std::size_t end = i + 1;
      if (!samples_[i].point_px) {
        while (end < samples_.size() && !samples_[end].point_px) ++end;
        // While samples arrive, a loss is long once it has lasted so long.
        for (std::size_t j = i; j < end; ++j) {
          const double known_s = std::min(samples_[j].time_s + ahead_s_, samples_[end - 1].time_s);
          in_long_loss_[j] = known_s - samples_[i].time_s > settings_.max_blink_s;
        }
        if (in_long_loss_[end - 1]) cuts_.push_back(end);
      }
      i = end;
    }
  }

  void sum(const Screen& screen) {
    sums_.resize(samples_.size() + 1);
    std::optional<glm::dvec3> first, last;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      Sums& next = sums_[i + 1] = sums_[i];
      if (!samples_[i].point_px) {
        last.reset();
        continue;
      }
      const glm::dvec3 sight = glm::degrees(1.0) * lineOfSight(screen, *samples_[i].point_px);
      if (!first) first = sight;
      if (last) {
        next.steps += 1.0;
        next.squared_steps += glm::dot(sight - *last, sight - *last);
      }
      next.present += 1.0;
      next.positions += sight - *first;
      next.squares += glm::dot(sight - *first, sight - *first);
      last = sight;
    }
  }

  bool isMostlyLost(const Window& window, std::size_t i) const {
    std::size_t first = window.first;
    if (ahead_s_ < window.before_s) {
      // The samples so far cannot tell whether gaze stays after a long loss.
      const auto cut = std::ranges::upper_bound(cuts_, i);
      if (cut != cuts_.begin()) first = std::max(first, *(cut - 1));
    }
    const double present = sums_[window.end].present - sums_[first].present;
    return present < (1.0 - kMaxLoss) * static_cast<double>(window.end - first);
  }

  bool isWhite(const Window& window) const {
    constexpr double kMinSpan_s = 0.9;  // a single fixation with noise tells nothing either
    const Sums &a = sums_[window.first], &b = sums_[window.end];
    const double steps = b.steps - a.steps, present = b.present - a.present;
    if (steps < kMinSpan_s * rate_Hz_) return false;
    const double step_deg2 = (b.squared_steps - a.squared_steps) / steps;
    const glm::dvec3 mean = (b.positions - a.positions) / present;
    const double variance_deg2 = (b.squares - a.squares) / present - glm::dot(mean, mean);
    // A step between two samples has twice the variance, along each of two axes.
    return step_deg2 > 4.0 * kMinNoise_deg * kMinNoise_deg &&
           step_deg2 > kWhiteRatio * variance_deg2;
  }

  void markFrozen(std::vector<SignalDoubt>& doubts) const {
    for (std::size_t i = 0; i < samples_.size();) {
      std::size_t end = i + 1, last = i;
      if (samples_[i].point_px) {
        for (; end < samples_.size(); ++end) {
          if (in_long_loss_[end]) break;
          if (!samples_[end].point_px) continue;
          if (*samples_[end].point_px != *samples_[i].point_px) break;
          last = end;
        }
        for (std::size_t j = i; j <= last; ++j) {
          const double known_s = std::min(samples_[j].time_s + ahead_s_, samples_[last].time_s);
          if (known_s - samples_[i].time_s >= kFrozen_s - 0.5 / rate_Hz_) {
            doubts[j] = SignalDoubt::frozen;
          }
        }
        end = last + 1;
      }
      i = end;
    }
  }

  const std::vector<GazeSample>& samples_;
  const EventSettings& settings_;
  double rate_Hz_, ahead_s_;
  bool is_simulated_;  // a simulated observer without noise rests exactly
  std::vector<bool> in_long_loss_{};
  std::vector<std::size_t> cuts_{};  // ends of the long losses
  std::vector<Sums> sums_{};
};

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
  return !trace.field || std::ranges::any_of(trace.samples, [](const auto& sample) {
    return sample.head.has_value();
  });
}

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

std::vector<SignalDoubt> signalDoubts(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings, double ahead_s) {
  return DoubtFinder(trace, screen, settings, ahead_s).find();
}

std::vector<std::string> doubtWarnings(const DoubtTimes& unjudged_s, Detector detector) {
  constexpr std::array<const char*, std::tuple_size_v<DoubtTimes>> kReasons = {
      "", "the rate is below 25 Hz", "more than half of each second is lost",
      "white noise is wider than saccades", "the position does not change in any digit"};
  std::vector<std::string> warnings;
  for (std::size_t k = 1; k < kReasons.size(); ++k) {
    if (unjudged_s[k] == 0.0) continue;
    const char* says =
        detector == Detector::rules ? " s tell nothing, because " : " s are unjudged, because ";
    warnings.push_back("events: " + decimal(unjudged_s[k], 3) + says + kReasons[k]);
  }
  return warnings;
}

}  // namespace foci
