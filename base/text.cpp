#include "base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

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

std::string exactText(double value) {
  if (!std::isfinite(value)) return value > 0 ? "inf" : value < 0 ? "-inf" : "nan";
  std::array<char, 40> text;
  const auto end = std::to_chars(text.begin(), text.end(), value).ptr;
  return {text.begin(), end};
}

std::string significant(double value, int digits) {
  std::array<char, 40> text;
  const auto end =
      std::to_chars(text.begin(), text.end(), value, std::chars_format::general, digits).ptr;
  return {text.begin(), end};
}

std::string thousands(double value) {
  std::string digits = decimal(value, 0);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string milliseconds(double ms) { return decimal(ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0); }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t last = text.find_last_not_of(kBlanks);
  return text.substr(first, last == std::string_view::npos ? 0 : last + 1 - first);
}

std::string_view withoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMaxBytes = 40;
  std::string result;
  for (char c : text.substr(0, kMaxBytes)) {
    result += c >= 0x20 && c < 0x7f ? c : '?';
  }
  if (text.size() > kMaxBytes) result += "...";
  return '"' + result + '"';
}

std::string quotedText(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape;
      std::snprintf(escape.data(), escape.size(), "\\u%04x", c);
      quoted += escape.data();
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace foci
