#include "gaze/live/live_source.h"

#include <algorithm>
#include <cmath>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {

void MouseSource::poll(double now_s, std::vector<GazeSample>& samples) {
  if (last_s_ && now_s <= *last_s_) return;
  last_s_ = now_s;
  samples.push_back({.time_s = now_s, .point_px = point_px_});
}

namespace {

constexpr double kSilence_s = 2.0;
constexpr const char* kExpected =
    "expected TIME X Y [PUPIL], e.g. 12.0345 960 540 3.1, and ; before the next sample";

/// The numbers of one sample; `nan` is none.
std::vector<std::optional<double>> numbersOf(std::string_view text) {
  std::vector<std::optional<double>> numbers;
  while (!(text = trimmed(text)).empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(word.size());
    const auto number = parseNumber(word);
    if (!number && word != "nan") throw InputError("gaze " + shown(word), kExpected);
    numbers.push_back(number);
  }
  return numbers;
}

GazeSample sampleOf(std::string_view text) {
  constexpr double kMaxClock_s = 1e10, kMaxPoint_px = 1e5, kMaxPupil_mm = 20.0;
  const auto numbers = numbersOf(text);
  if (numbers.size() < 3 || numbers.size() > 4 || !numbers[0] ||
      !(std::abs(*numbers[0]) < kMaxClock_s)) {
    throw InputError("gaze " + shown(trimmed(text)), kExpected);
  }
  GazeSample sample{.time_s = *numbers[0]};
  if (numbers[1] && numbers[2]) {
    if (!(std::max(std::abs(*numbers[1]), std::abs(*numbers[2])) < kMaxPoint_px)) {
      throw InputError("gaze " + shown(trimmed(text)), "expected a point in px of the screen");
    }
    sample.point_px = {*numbers[1], *numbers[2]};
  }
  if (numbers.size() == 4 && numbers[3]) {
    if (!(*numbers[3] >= 0.0 && *numbers[3] <= kMaxPupil_mm)) {
      throw InputError("gaze " + shown(trimmed(text)), "expected a pupil of 0 to 20 mm");
    }
    if (*numbers[3] > 0.0) sample.pupil_mm = numbers[3];
  }
  return sample;
}

}  // namespace

std::vector<GazeSample> samplesOfText(std::string_view text) {
  std::vector<GazeSample> samples;
  for (bool more = true; more;) {
    const std::size_t end = text.find(';');
    more = end != std::string_view::npos;
    const std::string_view one = trimmed(text.substr(0, end));
    if (more) text.remove_prefix(end + 1);
    if (one.empty() && !more && !samples.empty()) break;  // the text ends in `;`
    const GazeSample sample = sampleOf(one);
    if (!samples.empty() && sample.time_s <= samples.back().time_s) {
      throw InputError("gaze " + exactText(sample.time_s),
                       "expected a time after " + exactText(samples.back().time_s));
    }
    samples.push_back(sample);
  }
  return samples;
}

std::size_t PushedSource::push(const std::vector<GazeSample>& samples, double now_s) {
  const std::lock_guard lock(mutex_);
  const std::size_t before = waiting_.size(), dropped = clock_.dropped();
  clock_.take(samples, now_s, waiting_);
  if (waiting_.size() > before) heard_s_ = now_s;
  return clock_.dropped() - dropped;
}

void PushedSource::poll(double now_s, std::vector<GazeSample>& samples) {
  const std::lock_guard lock(mutex_);
  polled_s_ = now_s;
  samples.insert(samples.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
}

bool PushedSource::isHeard() const {
  const std::lock_guard lock(mutex_);
  return heard_s_ && polled_s_ - *heard_s_ <= kSilence_s;
}

SenderFacts PushedSource::sender() const {
  const std::lock_guard lock(mutex_);
  return {.dropped = clock_.dropped(), .why = kUnfitting, .clock = clock_.facts()};
}

}  // namespace foci
