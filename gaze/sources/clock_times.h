// Times that a table writes as dates and times of day, as seconds.
#pragma once

#include <optional>
#include <string_view>

namespace foci {

/// Reads one column. Each field is a date and a time of day, or a time of day: "10:00:00.123". The
/// date is "2026-11-26T" (with a blank instead of T, too), "2026/11/26 ", or "26.11.2026 ", where
/// dots put the day first. An offset such as Z or +02:00 may follow. All fields are of the same
/// kind as the first.
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

}  // namespace foci
