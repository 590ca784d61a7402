#include "gaze/sources/trace_summary.h"

#include <algorithm>

#include "base/text.h"

namespace foci {

int TraceSummary::binOf(double interval_s) const {
  constexpr double kMinInterval_s = 1e-6;
  int octave = 0;
  const double part = 2.0 * std::frexp(std::max(interval_s / kMinInterval_s, 1.0), &octave) - 1.0;
  return std::min((octave - 1) * kPerOctave + static_cast<int>(part * kPerOctave),
                  kPerOctave * kOctaves - 1);
}

int TraceSummary::medianBin() const {
  std::size_t below = 0;
  const std::size_t half = samples_ / 2;
  for (std::size_t bin = 0; bin < intervals_.size(); ++bin) {
    below += intervals_[bin];
    if (below >= std::max<std::size_t>(half, 1)) return static_cast<int>(bin);
  }
  return 0;
}

void TraceSummary::noteJump(double interval_s) {
  if (interval_s <= std::max(3.0 * usual_s_, 0.1)) return;
  ++jumps_;
  longest_jump_s_ = std::max(longest_jump_s_, interval_s);
}

void TraceSummary::add(const GazeSample& sample) {
  // Samples before the first update of the usual interval, and between updates.
  constexpr std::size_t kFirstUpdate = 16, kUpdateEvery = 1024;
  pauses_ += sample.after_pause;
  if (samples_ == 0) {
    first_s_ = sample.time_s;
  } else {
    const double interval_s = sample.time_s - last_s_;
    const auto bin = static_cast<std::size_t>(binOf(interval_s));
    ++intervals_[bin];
    sums_s_[bin] += interval_s;
    step_.add(interval_s);
    if (samples_ == kFirstUpdate || samples_ % kUpdateEvery == 0) {
      const auto usual = static_cast<std::size_t>(medianBin());
      usual_s_ = sums_s_[usual] / static_cast<double>(std::max<std::size_t>(intervals_[usual], 1));
      for (const double early_s : early_s_) noteJump(early_s);
      early_s_.clear();
    }
    if (samples_ < kFirstUpdate) {
      early_s_.push_back(interval_s);
    } else {
      noteJump(interval_s);
    }
  }
  last_s_ = sample.time_s;
  ++samples_;
  if (sample.point_px) {
    min_px_ = present_ == 0 ? *sample.point_px : glm::min(min_px_, *sample.point_px);
    max_px_ = present_ == 0 ? *sample.point_px : glm::max(max_px_, *sample.point_px);
    ++present_;
  }
  blinks_ += sample.blink;
  pupils_ +=
      sample.pupil_mm || sample.pupil_own || sample.eyes[0].pupil_own || sample.eyes[1].pupil_own;
  for (std::size_t side : {0, 1}) {
    eyes_[side] += sample.eyes[side].point_px || sample.eyes[side].direction;
  }
}

double TraceSummary::rate_Hz() const {
  if (samples_ < 2) return 0.0;
  const auto bin = static_cast<std::size_t>(medianBin());
  if (sums_s_[bin] <= 0.0) return 0.0;
  RoundedIntervals rounded(sums_s_[bin] / static_cast<double>(intervals_[bin]), step_.step_s());
  for (std::size_t i = 0; i < intervals_.size(); ++i) rounded.add(intervals_[i], sums_s_[i]);
  return rounded.rate_Hz();
}

std::vector<TraceTrial> trialsIn(const std::vector<TraceMarker>& messages, std::string_view start,
                                 double end_s) {
  constexpr std::string_view kResult = "TRIAL_RESULT", kVariable = "!V TRIAL_VAR ";
  std::vector<TraceTrial> trials;
  bool open = false;
  for (const TraceMarker& message : messages) {
    const std::string_view text = message.text;
    if (text.starts_with(kResult)) {
      if (!open) continue;
      trials.back().last_s = message.time_s;
      trials.back().result = trimmed(text.substr(kResult.size()));
      open = false;
    } else if (text.starts_with(start)) {
      if (open) trials.back().last_s = message.time_s;
      const std::string_view rest = trimmed(text.substr(start.size()));
      trials.push_back({.name = std::string(rest.empty() ? trimmed(text) : rest),
                        .first_s = message.time_s,
                        .last_s = std::max(end_s, message.time_s)});
      open = true;
    } else if (open && text.starts_with(kVariable)) {
      const std::string_view rest = trimmed(text.substr(kVariable.size()));
      const std::size_t end = std::min(rest.find(' '), rest.size());
      trials.back().variables.emplace_back(rest.substr(0, end), trimmed(rest.substr(end)));
    }
  }
  return trials;
}

const TraceTrial* trialDuring(const std::vector<TraceTrial>& trials, double time_s) {
  auto trial = std::ranges::upper_bound(trials, time_s, {}, &TraceTrial::first_s);
  while (trial != trials.begin()) {
    if (time_s < (--trial)->last_s) return &*trial;
  }
  return nullptr;
}

std::string trialAt(const std::vector<TraceTrial>& trials, double time_s) {
  const TraceTrial* const trial = trialDuring(trials, time_s);
  return trial == nullptr ? "n/a" : visible(trial->name);
}

}  // namespace foci
