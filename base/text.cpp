#include "base/text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace foci {

std::string decimal(double value, int digits) {
  std::array<char, 400> text;
  const auto result =
      std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, digits);
  std::string number(text.begin(), result.ptr);
  if (number[0] == '-' && number.find_first_of("123456789") == std::string::npos)
    number.erase(0, 1);
  return number;
}

std::string decimalOrInf(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "inf";
}

std::string thousands(double value) {
  std::string digits = decimal(value, 0);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string milliseconds(double ms) { return decimal(ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0); }

}  // namespace foci
