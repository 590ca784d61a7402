#include "gaze/sources/row_times.h"

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace foci {
namespace {

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
