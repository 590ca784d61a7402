// Agreement of labels with human coders: kappa of samples, F1 of events.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "gaze/events/event_labels.h"
#include "gaze/events/online_events.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct Interval {
  double from_s = 0.0, until_s = 0.0;
};

/// Pairs of intervals that share more than half of their union, and the intervals without a pair.
class EventAgreement {
 public:
  void add(const std::vector<Interval>& a, const std::vector<Interval>& b) {
    std::size_t first = 0;
    for (const Interval& x : a) {
      while (first < b.size() && b[first].until_s <= x.from_s) ++first;
      for (std::size_t j = first; j < b.size() && b[j].from_s < x.until_s; ++j) {
        const double both_s = std::min(x.until_s, b[j].until_s) - std::max(x.from_s, b[j].from_s);
        const double all_s = std::max(x.until_s, b[j].until_s) - std::min(x.from_s, b[j].from_s);
        if (both_s > 0.5 * all_s) pairs_ += 1.0;
      }
    }
    all_ += static_cast<double>(a.size() + b.size());
  }
  /// 2 pairs / (events of a + events of b); nothing without events.
  std::optional<double> f1() const {
    return all_ > 0.0 ? std::optional(2.0 * pairs_ / all_) : std::nullopt;
  }

 private:
  double pairs_ = 0.0, all_ = 0.0;
};

/// The agreement of two labellers, which adds up over recordings.
struct LabelAgreement {
  static constexpr std::array<GazeState, 3> kKinds = {GazeState::fixation, GazeState::saccade,
                                                      GazeState::pursuit};
  CohensKappa stable{};
  std::array<CohensKappa, 3> kinds{};
  std::array<EventAgreement, 3> events{};

  using Labels = std::vector<std::optional<GazeState>>;

  void addSamples(const Labels& a, const Labels& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!a[i] || !b[i]) continue;
      stable.add(isStable(*a[i]), isStable(*b[i]));
      for (std::size_t k = 0; k < kKinds.size(); ++k) {
        kinds[k].add(*a[i] == kKinds[k], *b[i] == kKinds[k]);
      }
    }
  }
  /// An event is a run of equal labels. Runs of `a` that `b` does not judge for the most part are
  /// left out.
  void addEvents(const Labels& a, const Labels& b, const GazeTrace& trace) {
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      events[k].add(runsOf(kKinds[k], a, b, trace), runsOf(kKinds[k], b, b, trace));
    }
  }

 private:
  static std::vector<Interval> runsOf(GazeState kind, const Labels& labels, const Labels& judged,
                                      const GazeTrace& trace) {
    std::vector<Interval> runs;
    for (std::size_t i = 0; i < labels.size();) {
      std::size_t end = i + 1, known = judged[i] ? 1 : 0;
      for (; end < labels.size() && labels[end] == labels[i]; ++end) known += judged[end] ? 1 : 0;
      if (labels[i] == kind && 2 * known >= end - i) {
        runs.push_back(
            {trace.samples[i].time_s, trace.samples[end - 1].time_s + 1.0 / trace.rate_Hz});
      }
      i = end;
    }
    return runs;
  }
};

}  // namespace foci
