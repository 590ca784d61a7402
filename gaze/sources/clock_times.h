// Times that a table writes as dates and times of day (ISO 8601), as seconds.
#pragma once

#include <optional>
#include <string_view>

namespace foci {

/// Reads one column. Each field is "2026-11-26T10:00:00.123Z" (also with an offset such as +02:00,
/// without one, or with a blank instead of T), or "10:00:00.123". All fields are of the same kind
/// as the first.
class ClockTimes {
 public:
  /// Of a date: seconds since 1970 in UTC, or in the recording's own zone if it states none. Of a
  /// time of day: seconds since the first midnight. A step back by more than half a day passes
  /// midnight. Exact to a microsecond.
  /// @return nothing for any other text
  std::optional<double> seconds(std::string_view text);

  bool hasDates() const { return has_dates_.value_or(false); }
  bool passesMidnight() const { return midnights_s_ > 0.0; }

 private:
  std::optional<bool> has_dates_{};  // unknown before the first field
  double last_s_ = 0.0, midnights_s_ = 0.0;
};

}  // namespace foci
