#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace foci {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

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

std::string counted(std::size_t count, const std::string& one) {
  return thousands(static_cast<double>(count)) + " " + one + (count == 1 ? "" : "s");
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

namespace {

struct CodePoint {
  char32_t value;
  std::size_t bytes;
};

/// The code point at the start of a text that is not empty; absent unless it is UTF-8 (RFC 3629).
std::optional<CodePoint> codePointAt(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return CodePoint{byte(0), 1};
  const std::size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) return std::nullopt;
  char32_t value = byte(0) & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0u) != 0x80u) return std::nullopt;
    value = value << 6 | (byte(i) & 0x3fu);
  }
  const bool surrogate = value >= 0xd800 && value <= 0xdfff;
  if (value < kLeast.at(bytes) || value > 0x10ffff || surrogate) return std::nullopt;
  return CodePoint{value, bytes};
}

/// Control characters of ASCII and Latin-1; separators of lines and paragraphs; characters that
/// change the direction of the text (Unicode 15, section 23.2).
bool isControl(char32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x61c || (c >= 0x200e && c <= 0x200f) ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;
}

}  // namespace

std::size_t utf8Length(std::string_view text) {
  const auto point = codePointAt(text);
  return point ? point->bytes : 0;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMaxBytes = 40;
  std::string result;
  while (!text.empty()) {
    const auto point = codePointAt(text);
    const std::size_t bytes = point ? point->bytes : 1;
    if (result.size() + bytes > kMaxBytes) return '"' + result + "...\"";
    result += point && !isControl(point->value) ? text.substr(0, bytes) : "?";
    text.remove_prefix(bytes);
  }
  return '"' + result + '"';
}

std::string visible(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  while (!text.empty()) {
    const auto point = codePointAt(text);
    const std::size_t bytes = point ? point->bytes : 1;
    if (!point) {
      line += printed("\\x%02x", static_cast<unsigned char>(text[0]));
    } else if (!isControl(point->value)) {
      line += text.substr(0, bytes);
    } else if (const auto at = std::string_view("\n\r\t").find(text[0]); at != text.npos) {
      line += '\\';
      line += "nrt"[at];
    } else {
      line += printed(point->value < 0x100 ? "\\x%02x" : "\\u%04x", point->value);
    }
    text.remove_prefix(bytes);
  }
  return line;
}

std::string quotedText(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += printed("\\u%04x", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

char lowered(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = lowered(c);
  return small;
}

std::vector<std::string_view> wordsOf(std::string_view text, std::string_view between) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(between, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(between, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<double> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  // from_chars does not say whether the value is too large or too small.
  return error == std::errc() ? value : std::strtod(std::string(word).c_str(), nullptr);
}

}  // namespace foci
