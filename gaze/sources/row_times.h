// The times of a table's rows: their unit, their order, and rows that share a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_row.h"

namespace foci {

struct ClockGuess {
  double scale_s = 1.0;   ///< seconds per unit of time
  std::string why{};      ///< what makes the unit likely; empty: the rate alone
  std::string doubt{};    ///< a warning; empty: none
  std::string refusal{};  ///< why the unit cannot be told; empty: it can
  bool is_open = false;   ///< more samples may tell more
};

/// The unit that gives the rate of an eye tracker: s, ms, us or ns; 100 ns (the ticks of .NET and
/// Windows), 0.1 ms or minutes only if the rate is a usual one. A time since 1970, 1601 or the year
/// 1 tells the unit itself. If two units are left, the usual duration of a fixation tells them
/// apart.
/// @param samples  the first ones, with times in the file's unit
/// @param rate_Hz  that the file states: it tells the unit
ClockGuess guessClock(const std::vector<GazeSample>& samples, std::optional<double> rate_Hz = {});

/// Warns if the usual intervals contradict the rate that a recording states.
void warnOfRate(double stated_Hz, std::vector<double> intervals_s, TraceHeader& header);

/// Reads a column of times as texts. Each field is a date and a time of day, or a time of day:
/// "10:00:00.123". The date is "2026-11-26T" (with a blank instead of T, too), "2026/11/26 ", or
/// "26.11.2026 ", where dots put the day first. An offset such as Z or +02:00 may follow. All
/// fields are of the same kind as the first.
class ClockTimes {
 public:
  /// Of a date: seconds since 1970 in UTC, or in the recording's own zone if it states none. Of a
  /// time of day: seconds since the first midnight. A step back by more than half a day passes
  /// midnight. Exact to a microsecond.
  /// @return nothing for any other text
  std::optional<double> seconds(std::string_view text);

  enum class DateForm { none, iso, slashes, dots_day_first };

  bool hasDates() const { return form_.value_or(DateForm::none) != DateForm::none; }
  bool passesMidnight() const { return midnights_s_ > 0.0; }

 private:
  std::optional<DateForm> form_{};  // unknown before the first field
  double last_s_ = 0.0, midnights_s_ = 0.0;
};

/// Whether a text starts with a date such as "03/04/2026", whose first number may be month or day.
bool isAmbiguousDate(std::string_view text);

/// Gives times in whole milliseconds the steps of the tracker's own clock. The offset between the
/// clocks of computer and tracker follows their drift, and is reset after a jump of either.
class FineClock {
 public:
  bool isUsed() const { return offset_ms_.has_value(); }

  double time_ms(double whole_ms, double fine_ms) {
    const double ahead_ms = offset_ms_ ? whole_ms - fine_ms - *offset_ms_ : kJump_ms;
    if (std::abs(ahead_ms) >= kJump_ms) {
      offset_ms_ = whole_ms - fine_ms;
    } else {
      *offset_ms_ += kFollow * ahead_ms;
    }
    return fine_ms + *offset_ms_;
  }

 private:
  // Whole milliseconds are within 1 of the truth, and quartz drifts by less than 1 ms in ten
  // seconds. A thousandth a sample follows in a few seconds.
  static constexpr double kJump_ms = 20.0, kFollow = 1e-3;

  std::optional<double> offset_ms_{};
};

/// Gives distinct times to samples that share a time, because times are whole units and samples
/// come faster: each follows the one before by an even interval, within its unit. A control loop
/// (proportional and integral, critically damped) keeps the times in the middle of their units.
class WholeTimes {
 public:
  explicit WholeTimes(double interval) : interval_(interval) {}

  double interval() const { return interval_; }

  /// Increases strictly. @param whole  does not decrease
  double time(double whole) {
    constexpr double kGain = 0.01;  // settles within a few hundred samples
    const double end = whole + 1.0;
    double at = last_ ? *last_ + interval_ : whole;
    const double error = whole + 0.5 - at;
    if (std::abs(error) <= 1.0) {
      at += kGain * error;
      interval_ += 0.25 * kGain * kGain * error;
    }
    at = std::max(at, whole);
    if (at >= end) at = 0.5 * (*last_ + end);
    last_ = at;
    return at;
  }

 private:
  double interval_;
  std::optional<double> last_{};
};

/// Gives each sample its time in seconds, and passes the samples on in order of time. Samples wait
/// until the unit of time is known, and until the next one shows that no two are swapped.
class RowTimes {
 public:
  /// @param row  at the sample's row in `read` and `add`; all arguments outlive the object
  RowTimes(TableLayout& layout, const TableRow& row, const Rows& rows, const TraceColumns& columns,
           const TakeSample& take);

  /// Of the latest row, in the file's unit. @throws InputError
  double read();
  /// Seconds; 0 while the unit is unknown.
  double seconds(double time) const { return clock_known_ ? time * layout_.time_scale_s : 0.0; }

  /// @param sample  its time is that of `read`
  /// @throws InputError if its place in time is not clear
  void add(const GazeSample& sample);

  /// Passes on the samples that wait. @throws InputError
  void finish();

  /// What was assumed about the times.
  void state(TraceHeader& header) const;

 private:
  double readClockTime();
  bool takeRepeat(const GazeSample& sample);
  InputError backwards(const GazeSample& sample) const;
  void order(GazeSample& sample);
  void settle(bool at_end);
  void emit(GazeSample& sample);

  TableLayout& layout_;
  const TableRow& row_;
  const Rows& rows_;
  const TraceColumns& given_;
  const TakeSample& take_;
  FineClock fine_clock_{};
  std::optional<ClockTimes> clock_times_{};  // the times are texts
  bool clock_known_ = false;
  std::optional<ClockGuess> guess_{};
  bool settled_ = false;                      // the unit of time; until then samples are held
  std::optional<GazeSample> newest_{};        // waits for the next one
  std::optional<double> first_{}, before_{};  // times of the first one, and of the one before
  std::optional<InputError> first_repeat_{};  // of a time
  std::size_t copies_ = 0, swapped_ = 0, waits_ = 0, counted_ = 0, ordered_ = 0;
  std::optional<WholeTimes> spread_{};  // times repeat
  std::vector<GazeSample> held_{};
  std::optional<double> emitted_s_{};  // time of the latest one
  std::vector<double> intervals_s_{};  // the first ones
};

}  // namespace foci
