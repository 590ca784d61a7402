#include "gaze/sources/pushed_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/input_error.h"
#include "base/number.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kPause_s = 2.0;            // as with Pupil Core: the sender may have a new clock
constexpr std::size_t kMaxWaiting = 65536;  // bounds memory if nobody polls
constexpr double kStep_s = 1e-6;            // between samples that a smaller offset brings together
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
  constexpr double kMaxClock_s = 1e10, kMaxPoint_px = 1e6, kMaxPupil_mm = 20.0;
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

std::size_t PushedSource::push(std::string_view text) {
  std::vector<GazeSample> news;
  for (bool more = true; more;) {
    const std::size_t end = text.find(';');
    more = end != std::string_view::npos;
    const std::string_view one = trimmed(text.substr(0, end));
    if (more) text.remove_prefix(end + 1);
    if (one.empty() && !more && !news.empty()) break;  // the text ends in `;`
    news.push_back(sampleOf(one));
  }
  push(news);
  return news.size();
}

void PushedSource::push(const std::vector<GazeSample>& news) {
  const std::lock_guard lock(mutex_);
  std::optional<double> last_s = sent_s_;
  for (const GazeSample& sample : news) {
    if (last_s && sample.time_s <= *last_s) {
      throw InputError("gaze " + exactText(sample.time_s),
                       "expected a time after " + exactText(*last_s));
    }
    last_s = sample.time_s;
  }
  if (waiting_.size() + news.size() <= kMaxWaiting) {
    waiting_.insert(waiting_.end(), news.begin(), news.end());
  }
  sent_s_ = last_s;
}

void PushedSource::poll(double now_s, std::vector<GazeSample>& samples) {
  const std::lock_guard lock(mutex_);
  if (now_s - heard_s_ > kPause_s && offset_s_) {
    offset_s_.reset();
    if (waiting_.empty()) sent_s_.reset();
  }
  if (waiting_.empty()) return;
  heard_s_ = now_s;
  const double offset_s = now_s - waiting_.back().time_s;
  offset_s_ = std::min(offset_s_.value_or(offset_s), offset_s);
  for (GazeSample& sample : waiting_) {
    sample.time_s = std::min(sample.time_s + *offset_s_, now_s);
    // A smaller offset may move a sample to the time of one that was given, or before it.
    if (given_s_) sample.time_s = std::max(sample.time_s, *given_s_ + kStep_s);
    given_s_ = sample.time_s;
    samples.push_back(sample);
  }
  waiting_.clear();
}

bool PushedSource::isHeard() const {
  const std::lock_guard lock(mutex_);
  return offset_s_.has_value();
}

std::string PushedSource::status() const {
  return isHeard() ? "gaze from the socket" : "gaze from the socket, none yet";
}

}  // namespace foci
