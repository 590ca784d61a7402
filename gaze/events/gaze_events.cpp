// The rules for merging fixations and for their minimum duration are those of Tobii's filter (Olsen
// 2012).
#include "gaze/events/gaze_events.h"

#include <algorithm>
#include <cmath>

#include "gaze/events/gaze_speed.h"
#include "gaze/events/online_events.h"
#include "gaze/events/saccades.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/geometry/sampling_rate.h"

namespace foci {
namespace {

/// The noise that the online detector has measured when it labels each sample. It stays the same
/// over blocks of samples.
class BlockNoise {
 public:
  BlockNoise(std::span<const TimedSight> sights, double rate_Hz, const EventSettings& settings) {
    const Lookahead ahead(rate_Hz, settings);
    RecentNoise noise(rate_Hz, settings);
    bool is_new = false;
    std::size_t pushed = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      for (; pushed < std::min(i + ahead.delay + 1, sights.size()); ++pushed) {
        noise.push(sights[pushed]);
      }
      is_new |= noise.update();
      if (!is_new || i % ahead.hop != 0) continue;
      is_new = false;
      first_.push_back(i);
      from_s_.push_back(sights[i].time_s);
      noise_.push_back(noise.value());
    }
    // The first samples tell no noise. Unlike the online detector, we know the next ones.
    const auto isKnown = [](const SightNoise& each) { return each.velocity_deg_s[0] > 0.0; };
    const auto known = std::ranges::find_if(noise_, isKnown);
    if (known != noise_.end()) std::fill(noise_.begin(), known, *known);
  }

  std::size_t blocks() const { return noise_.size(); }
  std::size_t first(std::size_t block) const { return first_[block]; }
  const SightNoise& of(std::size_t block) const { return noise_[block]; }
  const SightNoise& at(double time_s) const {
    const auto after = std::upper_bound(from_s_.begin() + 1, from_s_.end(), time_s);
    return noise_[static_cast<std::size_t>(after - from_s_.begin()) - 1];
  }

 private:
  std::vector<std::size_t> first_{};
  std::vector<double> from_s_{};
  std::vector<SightNoise> noise_{};
};

/// Labels each block with its own noise. The samples on both sides of it are labelled with it,
/// since saccades and eyelids cross its ends. Removes the spikes of `sights`.
std::vector<GazeState> labelInBlocks(std::vector<TimedSight>& sights,
                                     const std::vector<bool>& blinks, const BlockNoise& noise,
                                     double rate_Hz, const EventSettings& settings) {
  constexpr double kContext_s = 0.5;  // holds the longest saccade, eyelid motion and window
  const auto context = static_cast<std::size_t>((kContext_s + settings.max_gap_s) * rate_Hz) + 1;
  const std::vector<TimedSight> raw = sights;
  std::vector<GazeState> states(raw.size());
  for (std::size_t block = 0; block < noise.blocks(); ++block) {
    const std::size_t first = noise.first(block);
    const std::size_t end = block + 1 < noise.blocks() ? noise.first(block + 1) : raw.size();
    const std::size_t from = first - std::min(first, context);
    const std::size_t until = std::min(end + context, raw.size());
    const auto at = [](auto& list, std::size_t i) {
      return list.begin() + static_cast<std::ptrdiff_t>(i);
    };
    const auto clean =
        withoutSpikes(std::span(raw).subspan(from, until - from), rate_Hz, noise.of(block));
    const auto labels = labelSaccades(clean, {at(blinks, from), at(blinks, until)}, rate_Hz,
                                      noise.of(block), settings);
    std::copy(at(clean, first - from), at(clean, end - from), at(sights, first));
    std::copy(at(labels, first - from), at(labels, end - from), at(states, first));
  }
  return states;
}

/// Consecutive samples [first, end) with the same label.
struct Stretch {
  std::size_t first = 0, end = 0;
  bool missing = false;  ///< no gaze, and the tracker reports no blink
  StableGaze gaze{};     ///< of a stretch without saccades
};

/// Splits the recording where the label changes or where time jumps. A blink that the tracker
/// reports and data loss are stretches of their own.
std::vector<Stretch> stretchesOf(const std::vector<GazeState>& states,
                                 const std::vector<TimedSight>& sights, const GazeTrace& trace) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool missing = !trace.samples[i].point_px && !trace.samples[i].blink;
    const bool goes_on = i > 0 && states[i] == states[i - 1];
    const bool same =
        goes_on && (states[i] == GazeState::blink
                        ? missing == stretches.back().missing
                        : sights[i].time_s - sights[i - 1].time_s <= longestStep_s(trace.rate_Hz));
    if (!same) stretches.push_back({.first = i, .end = i, .missing = missing});
    stretches.back().end = i + 1;
  }
  return stretches;
}

void gatherGaze(const std::vector<TimedSight>& sights, double rate_Hz,
                std::vector<Stretch>& stretches) {
  // A slow tracker's sample beside a saccade may belong to the saccade.
  constexpr double kSlow_Hz = 100.0;
  const std::size_t border = rate_Hz < kSlow_Hz ? 1 : 0;
  for (Stretch& stretch : stretches) {
    for (std::size_t i = stretch.first + border; i + border < stretch.end; ++i) {
      if (sights[i].direction) stretch.gaze.add(sights[i].time_s, *sights[i].direction);
    }
  }
}

/// Whether the stable gaze at `place` is pursuit, with its neighbours up to 0.2 s away.
bool isPursuitAmong(const std::vector<const StableGaze*>& stable, std::size_t place,
                    const BlockNoise& noise, const EventRules& rules) {
  constexpr double kNear_s = 0.2;
  const StableGaze& gaze = *stable[place];
  const StableGaze* before = place > 0 ? stable[place - 1] : nullptr;
  const StableGaze* after = place + 1 < stable.size() ? stable[place + 1] : nullptr;
  if (before && gaze.first_s() - before->newest_s() > kNear_s) before = nullptr;
  if (after && after->first_s() - gaze.newest_s() > kNear_s) after = nullptr;
  return gaze.isPursuit(noise.at(0.5 * (gaze.first_s() + gaze.newest_s())).sample_deg, rules,
                        before, after);
}

}  // namespace

std::vector<GazeState> labelByRules(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings) {
  std::vector<TimedSight> sights;
  std::vector<bool> blinks;
  sights.reserve(trace.samples.size());
  for (const GazeSample& sample : trace.samples) {
    sights.push_back(sightOf(sample, screen));
    blinks.push_back(sample.blink);
  }
  const BlockNoise noise(sights, trace.rate_Hz, settings);
  auto states = labelInBlocks(sights, blinks, noise, trace.rate_Hz, settings);

  // Tell pursuit from fixation.
  std::vector<Stretch> stretches = stretchesOf(states, sights, trace);
  gatherGaze(sights, trace.rate_Hz, stretches);
  std::vector<const StableGaze*> stable;
  for (const Stretch& stretch : stretches) {
    constexpr double kMinSamples = 3.0;  // for a velocity
    const bool is_fixation = states[stretch.first] == GazeState::fixation;
    if (is_fixation && stretch.gaze.count() >= kMinSamples) stable.push_back(&stretch.gaze);
  }
  std::size_t place = 0;  // of the stretch within `stable`
  for (const Stretch& stretch : stretches) {
    GazeState state = states[stretch.first];
    if (place < stable.size() && stable[place] == &stretch.gaze) {
      if (isPursuitAmong(stable, place, noise, settings.rules)) state = GazeState::pursuit;
      ++place;
    }
    // Tell data loss from blinks.
    if (state == GazeState::blink && stretch.missing &&
        sights[stretch.end - 1].time_s - sights[stretch.first].time_s > settings.max_blink_s) {
      state = GazeState::lost;
    }
    std::ranges::fill(std::span(states).subspan(stretch.first, stretch.end - stretch.first), state);
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

  std::vector<GazeEvent> build(const std::vector<GazeState>& states) {
    std::vector<GazeEvent> events;
    for (const Run& run : mergedFixations(runsOf(states))) {
      const double duration_s = durationOf(run);
      if (isStable(run.state) && duration_s < settings_.min_fixation_s) continue;
      events.push_back(eventOf(run, duration_s));
    }
    return events;
  }

 private:
  /// Whether a sample follows the previous one without a break in the recording.
  bool follows(std::size_t next) const {
    const double gap_s = trace_.samples[next].time_s - trace_.samples[next - 1].time_s;
    return gap_s <= std::max(settings_.merge_gap_s, 1.5 / trace_.rate_Hz);
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

  /// End of the run: the time of the next sample or, before a break in the recording, one interval
  /// after the last sample.
  double endOf(const Run& run) const {
    const std::size_t next = run.last + 1;
    if (next < trace_.samples.size() && follows(next)) return trace_.samples[next].time_s;
    return trace_.samples[run.last].time_s + 1.0 / trace_.rate_Hz;
  }

  double durationOf(const Run& run) const { return endOf(run) - trace_.samples[run.first].time_s; }

  /// The sample in the middle of a run. With head poses, its head sees the run's points.
  const GazeSample& middleOf(const Run& run) const {
    return trace_.samples[(run.first + run.last) / 2];
  }

  /// @param seer  whose head sees the points
  std::optional<glm::dvec2> meanOf_px(const Run& run, const GazeSample& seer) const {
    glm::dvec2 mean{0.0};
    double count = 0.0;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const auto point_px = pointSeenBy_px(seer, trace_.samples[i], screen_);
      if (!point_px) continue;
      count += 1.0;
      mean += (*point_px - mean) / count;
    }
    return count > 0.0 ? std::optional(mean) : std::nullopt;
  }

  /// Joins two fixations if little time and little distance lie between them. The runs between the
  /// two disappear.
  std::vector<Run> mergedFixations(const std::vector<Run>& runs) const {
    std::vector<Run> merged;
    std::optional<std::size_t> before;  // index of the latest stable run in `merged`
    for (const Run& run : runs) {
      if (isStable(run.state) && before) {
        const Run& fixation = merged[*before];
        const double gap_s = trace_.samples[run.first].time_s - endOf(fixation);
        const GazeSample& seer = middleOf(fixation);
        const auto a = meanOf_px(fixation, seer), b = meanOf_px(run, seer);
        if (run.state == fixation.state && gap_s < settings_.merge_gap_s && a && b &&
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
    if (trace_.relative) return event;
    if (isStable(run.state)) event.position_px = meanOf_px(run, middleOf(run));
    if (run.state != GazeState::saccade) return event;

    // A saccade starts at the last sample before it.
    std::size_t first = run.first > 0 && follows(run.first) ? run.first - 1 : run.first;
    while (first < run.last && !trace_.samples[first].point_px) ++first;
    std::size_t last = run.last;
    while (last > first && !trace_.samples[last].point_px) --last;
    event.start_px = trace_.samples[first].point_px;
    event.position_px = trace_.samples[last].point_px;
    if (event.start_px && event.position_px) {
      const auto start_px = pointSeenBy_px(trace_.samples[last], trace_.samples[first], screen_);
      event.amplitude_deg =
          start_px ? angleBetween_deg(screen_, *start_px, *event.position_px) : 180.0;
    }
    event.peak_velocity_deg_s = peakSpeed_deg_s(first, last);
    return event;
  }

  /// The windows are 8 ms long, or two samples. The detector's longer windows would flatten the
  /// peak.
  double peakSpeed_deg_s(std::size_t first, std::size_t last) const {
    constexpr double kWindow_s = 0.008;
    const auto span = static_cast<std::size_t>(std::lround(kWindow_s * trace_.rate_Hz));
    const std::size_t length = std::min(std::max<std::size_t>(span + 1, 2), last - first + 1);
    std::vector<TimedSight> sights;
    double peak = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      sights.push_back(sightOf(trace_.samples[i], screen_));
      if (sights.size() < length) continue;
      const auto velocity = velocityOfSight_deg_s(std::span(sights).last(length));
      if (velocity) peak = std::max(peak, glm::length(*velocity));
    }
    return peak;
  }

  const GazeTrace& trace_;
  const Screen& screen_;
  const EventSettings& settings_;
};

}  // namespace

std::vector<GazeEvent> eventsOf(const std::vector<GazeState>& states, const GazeTrace& trace,
                                const Screen& screen, const EventSettings& settings) {
  const auto stretches = rateStretchesOf(trace);
  if (stretches.size() == 1) return EventBuilder(trace, screen, settings).build(states);
  std::vector<GazeEvent> events;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const GazeTrace stretch = stretchOf(trace, stretches, i);
    const auto first = states.begin() + static_cast<std::ptrdiff_t>(stretches[i].first);
    const auto part =
        EventBuilder(stretch, screen, settings)
            .build({first, first + static_cast<std::ptrdiff_t>(stretch.samples.size())});
    events.insert(events.end(), part.begin(), part.end());
  }
  return events;
}

}  // namespace foci
