#include "gaze/sources/row_times.h"

#include <bit>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <regex>

#include "base/quantile.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kMaxTime_s = 1e11;     // up to here a double resolves 20 us
constexpr std::size_t kEnough = 128;    // samples, for the usual interval
constexpr std::size_t kMaxHeld = 8192;  // samples, for the usual duration of a fixation

bool sameEye(const EyeSample& a, const EyeSample& b) {
  return a.point_px == b.point_px && a.origin_m == b.origin_m && a.direction == b.direction &&
         a.pupil_mm == b.pupil_mm;
}

/// Whether two rows of one time say the same.
bool isCopy(const GazeSample& a, const GazeSample& b) {
  return a.point_px == b.point_px && a.pupil_mm == b.pupil_mm && a.blink == b.blink &&
         a.direction == b.direction && sameEye(a.eyes[0], b.eyes[0]) &&
         sameEye(a.eyes[1], b.eyes[1]);
}

using DateForm = ClockTimes::DateForm;

constexpr double kDay_s = 86'400.0;

/// A date and the blank or T behind it: the year first, as "2026-11-26T" or "2026/11/26 ", or the
/// day first with dots, "26.11.2026 ". Then "10:00:00.123"; some programs write a decimal comma, a
/// colon before three digits of milliseconds, or one digit of an hour. At last "Z", "+02:00",
/// "+0200", "+02" or nothing.
constexpr const char* kClockText =
    "(?:(?:(\\d{4})([-/])(\\d{2})\\2(\\d{2})|(\\d{1,2})\\.(\\d{1,2})\\.(\\d{4}))[Tt ])?"
    "(\\d{1,2}):(\\d{2}):(\\d{2})(?::(\\d{3})|[.,](\\d{1,9}))?"
    "([Zz]|([+-])(\\d{2}):?(\\d{2})?)?";

}  // namespace

void warnOfRate(double stated_Hz, std::vector<double> intervals_s, TraceHeader& header) {
  constexpr double kOther = 1.1;
  if (intervals_s.size() < kEnough) return;
  const double usual_s = quantile(intervals_s, 0.5);
  // The median of whole milliseconds is none of the tracker's.
  std::erase_if(intervals_s, [&](double each) { return std::abs(each - usual_s) > 0.5 * usual_s; });
  const double rate_Hz = static_cast<double>(intervals_s.size()) /
                         std::accumulate(intervals_s.begin(), intervals_s.end(), 0.0);
  if (rate_Hz <= kOther * stated_Hz && stated_Hz <= kOther * rate_Hz) return;
  header.warnings.push_back("the stated sampling rate is " + significant(stated_Hz) +
                            " Hz, but there are " + significant(rate_Hz) +
                            " samples a second: is the unit of time right (gaze.time_scale_s)?");
}

RowTimes::RowTimes(TableLayout& layout, const TableRow& row, const Rows& rows,
                   const TraceColumns& columns, const TakeSample& take)
    : layout_(layout),
      row_(row),
      rows_(rows),
      given_(columns),
      take_(take),
      clock_known_(layout.time_scale_s > 0.0) {}

double RowTimes::read() {
  if (!layout_.time) return static_cast<double>(counted_++) / layout_.rate_Hz;
  if (clock_times_) return readClockTime();
  const std::size_t column = *layout_.time;
  const auto time = row_.number(column);
  if (!time && !first_ && ClockTimes().seconds(row_.field(column))) {
    if (given_.time_scale_s) {
      row_.fail(column, "a clock's time is in seconds: expected no gaze.time_scale_s");
    }
    clock_times_.emplace();
    clock_known_ = true;
    layout_.time_scale_s = 1.0;
    return readClockTime();
  }
  if (time && std::abs(*time) * std::max(layout_.time_scale_s, 1e-9) > kMaxTime_s) {
    row_.fail(column,
              "too large a time: is its unit right (gaze.time_scale_s; 1e-7 for .NET's ticks)?");
  }
  if (!time && isAmbiguousDate(row_.field(column))) {
    row_.fail(column,
              "a date whose first number may be the day or the month: write the year first, as "
              "2026-11-26 10:00:00.123");
  }
  if (!time) {
    row_.fail(column,
              "expected a time in numbers, as 2026-11-26T10:00:00.123 or as 10:00:00.123; "
              "another column can be named with gaze.time");
  }
  const auto fine_us = layout_.fine_time ? row_.number(*layout_.fine_time) : std::nullopt;
  return fine_us ? fine_clock_.time_ms(*time, 1e-3 * *fine_us) : *time;
}

double RowTimes::readClockTime() {
  const auto time_s = clock_times_->seconds(row_.field(*layout_.time));
  if (!time_s) row_.fail(*layout_.time, "expected a time of the same form as the first");
  return *time_s;
}

/// A row that has the time of the newest one. @return whether it may be a sample of its own
bool RowTimes::takeRepeat(const GazeSample& sample) {
  if (spread_) return true;
  if (isCopy(sample, *newest_)) {
    ++copies_;
    return !settled_;
  }
  if (!first_repeat_) {
    first_repeat_ = rows_.error(
        "time " + shown(row_.field(*layout_.time)) +
        " is not after the sample before: remove one of the two rows, which differ, choose rows "
        "with gaze.rows, or name a finer clock with gaze.time");
  }
  // Whole milliseconds may repeat above 1000 Hz.
  if (settled_ || sample.time_s != std::floor(sample.time_s)) throw *first_repeat_;
  return true;
}

/// Why a time lies before those of two samples or more.
InputError RowTimes::backwards(const GazeSample& sample) const {
  constexpr double kFewRows = 8.0;
  const double back = newest_->time_s - sample.time_s, span = newest_->time_s - *first_;
  const std::string what =
      "time " + shown(row_.field(*layout_.time)) + " is not after the sample before: ";
  if (back <= kFewRows * span / static_cast<double>(ordered_)) {
    return rows_.error(what +
                       "the rows are not in order of time: sort them, or name the tracker's own "
                       "clock with gaze.time; times of arrival may come in another order");
  }
  if (sample.time_s - *first_ <= 0.1 * span) {
    return rows_.error(what +
                       "the clock starts anew: if a column tells the parts apart, read one of them "
                       "with gaze.rows, or write a file for each");
  }
  return rows_.error(what + "the clock was set back: write a file for the rows from here on");
}

void RowTimes::add(const GazeSample& sample) {
  constexpr std::size_t kMaxWaits = 8;  // rows that come too late, behind one
  if (!first_) first_ = sample.time_s;
  if (newest_ && sample.time_s < newest_->time_s) {
    if (spread_ || (before_ && sample.time_s <= *before_)) throw backwards(sample);
    if (++waits_ > kMaxWaits) {
      throw rows_.error("this row and " + std::to_string(kMaxWaits) +
                        " before it are earlier than a row before them, so its time " +
                        exactText(newest_->time_s) + " is wrong: remove it");
    }
    ++swapped_;
    first_ = std::min(*first_, sample.time_s);
    GazeSample earlier = sample;
    order(earlier);
    return;
  }
  if (newest_ && sample.time_s == newest_->time_s && !takeRepeat(sample)) return;
  if (newest_) order(*newest_);
  newest_ = sample;
  waits_ = 0;
}

/// @param sample  is no longer needed
void RowTimes::order(GazeSample& sample) {
  before_ = sample.time_s;
  ++ordered_;
  if (settled_) return emit(sample);
  held_.push_back(sample);
  // Each guess looks at all samples that wait.
  if (held_.size() >= kEnough && std::has_single_bit(held_.size())) settle(false);
}

/// Chooses the unit of time, and how repeated times are told apart.
/// @throws InputError if times repeat without a reason
void RowTimes::settle(bool at_end) {
  if (settled_) return;
  if (!clock_known_) {
    guess_ = guessClock(held_, rows_.before().rate_Hz);
    if (guess_->is_open && !at_end && held_.size() < kMaxHeld) return;
    if (!guess_->refusal.empty()) throw InputError(rows_.source(), guess_->refusal);
    layout_.time_scale_s = guess_->scale_s;
    clock_known_ = true;
  }
  settled_ = true;
  if (first_repeat_ || copies_ > 0) {
    // Above 1000 Hz, whole milliseconds cannot but repeat. A few copies are none of this.
    constexpr double kManyCopies = 0.95;
    const double interval = (held_.back().time_s - held_.front().time_s) /
                            static_cast<double>(std::max<std::size_t>(held_.size(), 2) - 1);
    const double longest = first_repeat_ ? 1.0 : kManyCopies;
    if (layout_.time_scale_s == 1e-3 && interval > 0.0 && interval < longest) {
      spread_.emplace(interval);
      copies_ = 0;
    } else if (first_repeat_) {
      throw *first_repeat_;
    }
  }
  for (GazeSample& sample : held_) emit(sample);
  held_.clear();
}

/// A copy has the time of the latest one.
/// @param sample  its time is in the file's unit
void RowTimes::emit(GazeSample& sample) {
  if (spread_) sample.time_s = spread_->time(sample.time_s);
  sample.time_s *= layout_.time_scale_s;
  if (emitted_s_ == sample.time_s) return;
  if (emitted_s_ && intervals_s_.size() < kMaxHeld) {
    intervals_s_.push_back(sample.time_s - *emitted_s_);
  }
  emitted_s_ = sample.time_s;
  take_(sample);
}

void RowTimes::finish() {
  if (newest_) order(*newest_);
  newest_.reset();
  settle(true);
}

void RowTimes::state(TraceHeader& header) const {
  if (layout_.time && rows_.before().rate_Hz) {
    warnOfRate(*rows_.before().rate_Hz, intervals_s_, header);
  }
  if (spread_) {
    header.warnings.push_back(
        "times are whole milliseconds and repeat: foci spreads the samples evenly; export the "
        "times in microseconds");
  }
  if (fine_clock_.isUsed()) {
    header.assumed.push_back(
        "intervals: those of the tracker's own clock, since times are whole milliseconds");
  }
  if (copies_ > 0) {
    header.warnings.push_back(std::to_string(copies_) + (copies_ == 1 ? " row is" : " rows are") +
                              " exact copies of the row before and left out");
  }
  if (swapped_ > 0) {
    header.warnings.push_back(std::to_string(swapped_) +
                              (swapped_ == 1 ? " row came" : " rows came") +
                              " before an earlier one: neighbours are sorted by time");
  }
  if (clock_times_) {
    ColumnReading& reading = header.columns[*layout_.time];
    reading.meaning = clock_times_->hasDates() ? "time, a date and a time of day" : "time of day";
    reading.why = "certain: its fields state the format";
    if (clock_times_->passesMidnight()) {
      header.assumed.push_back("clock: passes midnight where it steps back by over half a day");
    }
  }
  if (!guess_) return;
  header.assumed.push_back("unit of time: " + exactText(guess_->scale_s) + " s, from " +
                           (guess_->why.empty() ? "the rate" : guess_->why) +
                           " (gaze.time_scale_s)");
  if (!guess_->doubt.empty()) header.warnings.push_back(guess_->doubt);
}

std::optional<double> ClockTimes::seconds(std::string_view text) {
  static const std::regex clock(kClockText);
  std::cmatch parts;
  if (!std::regex_match(text.data(), text.data() + text.size(), parts, clock)) return std::nullopt;
  const auto number = [&](std::size_t part) {  // 0 for what is left out
    int value = 0;
    std::from_chars(parts[part].first, parts[part].second, value);
    return value;
  };
  const bool day_first = parts[5].matched, has_date = day_first || parts[1].matched;
  const DateForm form = day_first                ? DateForm::dots_day_first
                        : !has_date              ? DateForm::none
                        : *parts[2].first == '/' ? DateForm::slashes
                                                 : DateForm::iso;
  const bool has_offset = parts[13].matched;
  if (form_.value_or(form) != form || (has_offset && !has_date)) return std::nullopt;
  if (number(8) > 23 || number(9) > 59 || number(10) > 59) return std::nullopt;
  if (number(15) > 14 || number(16) > 59) return std::nullopt;
  double date_s = 0.0;
  if (has_date) {
    const std::chrono::year_month_day date(
        std::chrono::year(number(day_first ? 7 : 1)),
        std::chrono::month(static_cast<unsigned>(number(day_first ? 6 : 3))),
        std::chrono::day(static_cast<unsigned>(number(day_first ? 5 : 4))));
    if (!date.ok()) return std::nullopt;
    date_s = kDay_s * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  }
  const double fraction_s =
      parts[11].matched ? 1e-3 * number(11) : number(12) / std::pow(10.0, parts[12].length());
  const double of_day_s = 3600.0 * number(8) + 60.0 * number(9) + number(10) + fraction_s;
  const double offset_s = 3600.0 * number(15) + 60.0 * number(16);
  if (form_ && !has_date && of_day_s < last_s_ - 0.5 * kDay_s) midnights_s_ += kDay_s;
  form_ = form;
  last_s_ = of_day_s;
  const bool west = parts[14].matched && *parts[14].first == '-';
  return date_s + (west ? offset_s : -offset_s) + midnights_s_ + of_day_s;
}

bool isAmbiguousDate(std::string_view text) {
  static const std::regex date("\\d{1,2}[/-]\\d{1,2}[/-]\\d{2}");
  return std::regex_search(text.data(), text.data() + text.size(), date,
                           std::regex_constants::match_continuous);
}

}  // namespace foci
