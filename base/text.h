// Numbers, words, lists and quoted strings, from text and to it, the same in every locale.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace foci {

/// The parts one after another: texts, and integers in decimal.
template <typename... Parts>
std::string concat(const Parts&... parts) {
  std::string all;
  const auto add = [&all]<typename Part>(const Part& part) {
    if constexpr (std::is_integral_v<Part>) {
      all += std::to_string(part);
    } else {
      all += part;
    }
  };
  (add(parts), ...);
  return all;
}

/// Parts (`concat`) with tabs, or another character, between them.
template <char kBetween = '\t', typename First, typename... More>
std::string tabbed(const First& first, const More&... more) {
  std::string fields = concat(first);
  ((fields += kBetween, fields += concat(more)), ...);
  return fields;
}

/// A row of a table: its fields, and the line break.
template <char kBetween = '\t', typename... Fields>
std::string rowOf(const Fields&... fields) {
  return tabbed<kBetween>(fields...) + '\n';
}

/// `text` with `to` in place of each `from`, which is not empty.
std::string replaced(std::string text, std::string_view from, std::string_view to);

/// A field of CSV (RFC 4180): in double quotes if it holds a comma, a double quote or a line break.
inline std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return '"' + replaced(text, "\"", "\"\"") + '"';
}

/// The fields of a row between tabs.
inline std::vector<std::string> fieldsOf(std::string_view row) {
  std::vector<std::string> fields(1);
  for (const char c : row) {
    if (c == '\t') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// The elements of a list in one text.
/// @param textOf  an element's text
template <typename List, typename TextOf = std::identity>
std::string listed(const List& list, std::string_view between = ", ", const TextOf& textOf = {}) {
  std::string text;
  for (const auto& each : list) {
    if (!text.empty()) text += between;
    text += std::invoke(textOf, each);
  }
  return text;
}

/// What std::printf prints: at most 255 characters.
template <typename... Values>
std::string printed(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// `value` with `digits` digits after the decimal point. Never "-0".
std::string decimal(double value, int digits);

/// As `decimal`; "inf" for values that are not finite.
std::string decimalOrInf(double value, int digits);

/// The shortest decimal text that reads back as the same double; "inf", "-inf" or "nan".
std::string exactText(double value);

/// With up to `digits` significant digits.
std::string significant(double value, int digits = 4);

/// Rounded, with commas between groups of three digits: 12345.6 as "12,346".
std::string thousands(double value);

/// "1 point", "2,000 points".
std::string counted(std::size_t count, const std::string& one);

/// Milliseconds with about three significant digits.
std::string milliseconds(double ms);

/// `text` without the blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text);

/// `text` without the byte order mark of UTF-8 at its start.
std::string_view withoutByteOrderMark(std::string_view text);

/// A text from outside, ready for an error message: in double quotes, at most 40 bytes, with "?"
/// for each control character and each byte that is not UTF-8.
std::string shown(std::string_view text);

/// `text` on one line of a terminal, of a table between tabs or of a page: control characters, and
/// those of Unicode that break or turn lines, as escapes (`\n`, `\t`, `\x1b`, `\u202e`), and so
/// bytes that are not UTF-8 (`\xff`).
std::string visible(std::string_view text);

/// Bytes of the UTF-8 character at the start of a text that is not empty; 0: it starts with none.
std::size_t utf8Length(std::string_view text);

/// `text` in double quotes, escaped for JSON and TOML alike.
std::string quotedText(std::string_view text);

/// In small letters, as far as they are ASCII.
char lowered(char c);
std::string lowered(std::string_view text);

/// What stands between blanks, or between other characters.
std::vector<std::string_view> wordsOf(std::string_view text, std::string_view between = " \t\r\n");

/// A decimal number that fills the word, "nan" and "inf" among them. One that a double does not
/// hold is infinite, or 0.
std::optional<double> numberOf(std::string_view word);

/// A finite decimal number, with or without a sign. The number must fill the whole text, so that
/// "1 " and "1px" give nothing.
inline std::optional<double> parseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool fills = error == std::errc() && end == text.data() + text.size();
  return fills && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A decimal integer that fills the whole text and fits into the type. No plus sign.
template <std::integral Integer>
std::optional<Integer> parseInteger(std::string_view text) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool fills = error == std::errc() && end == text.data() + text.size();
  return fills ? std::optional(value) : std::nullopt;
}

}  // namespace foci
