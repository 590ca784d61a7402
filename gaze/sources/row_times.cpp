#include "gaze/sources/row_times.h"

#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <numeric>

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

/// Takes digits and signs from the front of a text.
class Front {
 public:
  explicit Front(std::string_view text) : text_(text) {}

  bool isEmpty() const { return text_.empty(); }
  bool starts(std::string_view any) const {
    return !text_.empty() && any.find(text_.front()) != any.npos;
  }
  bool take(std::string_view any) {
    const bool starts_so = starts(any);
    if (starts_so) text_.remove_prefix(1);
    return starts_so;
  }

  /// A whole number of so many digits.
  std::optional<int> number(std::size_t min_digits, std::size_t max_digits) {
    int value = 0;
    std::size_t digits = 0;
    for (; digits < max_digits && starts(kDigits); ++digits) value = 10 * value + takeDigit();
    return digits >= min_digits ? std::optional(value) : std::nullopt;
  }

  /// The digits behind a decimal point.
  std::optional<double> fraction() {
    constexpr std::size_t kMaxDigits = 9;
    std::int64_t value = 0, unit = 1;
    for (std::size_t digits = 0; digits < kMaxDigits && starts(kDigits); ++digits) {
      value = 10 * value + takeDigit();
      unit *= 10;
    }
    if (unit == 1) return std::nullopt;
    return static_cast<double>(value) / static_cast<double>(unit);
  }

 private:
  static constexpr std::string_view kDigits = "0123456789";

  int takeDigit() {
    const int digit = text_.front() - '0';
    text_.remove_prefix(1);
    return digit;
  }

  std::string_view text_;
};

/// The day of a date and the blank or T behind it, as seconds since 1970: "2026-11-26T" or
/// "2026/11/26 ", where the year is first, or "26.11.2026 ", where dots put the day first.
std::optional<double> dateIn(Front& text, DateForm form) {
  const bool day_first = form == DateForm::dots_day_first;
  const std::string_view between = day_first ? "." : form == DateForm::slashes ? "/" : "-";
  const auto first = day_first ? text.number(1, 2) : text.number(4, 4);
  if (!first || !text.take(between)) return std::nullopt;
  const auto month = text.number(day_first ? 1 : 2, 2);
  if (!month || !text.take(between)) return std::nullopt;
  const auto last = day_first ? text.number(4, 4) : text.number(2, 2);
  if (!last || !text.take("Tt ")) return std::nullopt;
  const std::chrono::year_month_day date(
      std::chrono::year(day_first ? *last : *first),
      std::chrono::month(static_cast<unsigned>(*month)),
      std::chrono::day(static_cast<unsigned>(day_first ? *first : *last)));
  if (!date.ok()) return std::nullopt;
  return kDay_s * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// "10:00:00.123"; some programs write a decimal comma, a colon before three digits of
/// milliseconds, or one digit of an hour.
std::optional<double> timeOfDayIn(Front& text) {
  const auto hour = text.number(1, 2);
  if (!hour || *hour > 23 || !text.take(":")) return std::nullopt;
  const auto minute = text.number(2, 2);
  if (!minute || *minute > 59 || !text.take(":")) return std::nullopt;
  const auto second = text.number(2, 2);
  if (!second || *second > 59) return std::nullopt;
  std::optional<double> fraction = 0.0;
  if (text.take(":")) {
    const auto ms = text.number(3, 3);
    fraction = ms ? std::optional(1e-3 * *ms) : std::nullopt;
  } else if (text.take(".,")) {
    fraction = text.fraction();
  }
  if (!fraction) return std::nullopt;
  return 3600.0 * *hour + 60.0 * *minute + *second + *fraction;
}

/// "Z", "+02:00", "+0200", "+02" or nothing.
std::optional<double> offsetIn(Front& text) {
  if (text.isEmpty() || text.take("Zz")) return 0.0;
  const double sign = text.starts("-") ? -1.0 : 1.0;
  if (!text.take("+-")) return std::nullopt;
  const auto hours = text.number(2, 2);
  if (!hours || *hours > 14) return std::nullopt;
  text.take(":");
  const auto minutes = text.isEmpty() ? std::optional(0) : text.number(2, 2);
  if (!minutes || *minutes > 59) return std::nullopt;
  return sign * (3600.0 * *hours + 60.0 * *minutes);
}

DateForm formOf(std::string_view text) {
  const std::size_t sign = text.find_first_of("-/.:");
  if (sign == text.npos || text[sign] == ':') return DateForm::none;
  if (text[sign] == '.') return DateForm::dots_day_first;
  return text[sign] == '/' ? DateForm::slashes : DateForm::iso;
}

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
        " is not after the sample before: remove one of the two rows, which differ, or name a "
        "finer clock with gaze.time");
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
  Front front(text);
  const DateForm form = formOf(text);
  if (form_.value_or(form) != form) return std::nullopt;
  const bool has_date = form != DateForm::none;
  const auto date_s = has_date ? dateIn(front, form) : std::optional(0.0);
  if (!date_s) return std::nullopt;
  const auto of_day_s = timeOfDayIn(front);
  const auto offset_s = of_day_s && has_date ? offsetIn(front) : std::optional(0.0);
  if (!of_day_s || !offset_s || !front.isEmpty()) return std::nullopt;
  if (form_ && !has_date && *of_day_s < last_s_ - 0.5 * kDay_s) midnights_s_ += kDay_s;
  form_ = form;
  last_s_ = *of_day_s;
  return *date_s - *offset_s + midnights_s_ + *of_day_s;
}

bool isAmbiguousDate(std::string_view text) {
  Front front(text);
  return front.number(1, 2) && front.take("/-") && front.number(1, 2) && front.take("/-") &&
         front.number(2, 4);
}

}  // namespace foci
