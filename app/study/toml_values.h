// Reads the values of a study from TOML and writes them as JSON, by one pair of functions for each
// type. toml11 is heavy to compile, so only study*.cpp include this.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/study/study.h"
#include "app/study/study_words.h"
#include "base/text.h"
#include "calibration/toml_file.h"

namespace foci {

using Words = std::vector<std::string_view>;

/// The values that a key allows. Every number lies from `low` to `high`. A text is one of `words`,
/// or any text if there are none. `expected` may refuse a text: it returns what was expected.
struct Allowed {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  Words words = {};
  std::optional<std::string> (*expected)(std::string_view) = nullptr;
};

/// Thrown for a value that the key does not allow.
struct Expected {
  std::string what;        ///< the key allows
  int line = 0;            ///< of the wrong element of a list, as parsed; 0: no list
  std::string there = {};  ///< what is wrong there

  std::string text(const TomlDocument& document) const {
    if (line == 0) return what;
    return what + ", but line " + std::to_string(document.lineOf(line)) + there;
  }
};

inline std::string rangeText(const Allowed& allowed) {
  return exactText(allowed.low) + " to " + exactText(allowed.high);
}

// For each type of key, `read` from TOML (@throws Expected) and `write` to JSON.

inline void read(const toml::value& from, const Allowed& allowed, double& to) {
  const double value = from.is_floating()  ? from.as_floating()
                       : from.is_integer() ? static_cast<double>(from.as_integer())
                                           : std::numeric_limits<double>::quiet_NaN();
  if (!(value >= allowed.low && value <= allowed.high)) throw Expected{rangeText(allowed)};
  to = value;
}

inline void read(const toml::value& from, const Allowed& allowed, float& to) {
  double value{};
  read(from, allowed, value);
  to = static_cast<float>(value);
}

template <std::signed_integral Integer>
void read(const toml::value& from, const Allowed& allowed, Integer& to) {
  const auto fits = [&](std::int64_t value) {
    return static_cast<double>(value) >= allowed.low && static_cast<double>(value) <= allowed.high;
  };
  if (!from.is_integer() || !fits(from.as_integer())) {
    throw Expected{"an integer, " + rangeText(allowed)};
  }
  to = static_cast<Integer>(from.as_integer());
}

inline void read(const toml::value& from, const Allowed&, bool& to) {
  if (!from.is_boolean()) throw Expected{"true or false"};
  to = from.as_boolean();
}

inline void read(const toml::value& from, const Allowed& allowed, std::string& to) {
  std::string what = allowed.words.empty() ? "a text" : "one of";
  for (const auto word : allowed.words) what += " \"" + std::string(word) + "\"";
  if (!from.is_string()) throw Expected{what};
  const auto& text = toml::get<std::string>(from);
  const bool known = allowed.words.empty() || std::ranges::count(allowed.words, text) > 0;
  if (text.empty() || text.find('\0') != std::string::npos || !known) {
    throw Expected{text.empty() ? what + " that is not empty" : what};
  }
  if (allowed.expected) {
    if (const auto instead = allowed.expected(text)) throw Expected{*instead};
  }
  to = text;
}

/// Reads what is a part of `what`. @throws Expected{what}
template <class T>
void readPart(const std::string& what, const toml::value& from, const Allowed& allowed, T& to) {
  try {
    read(from, allowed, to);
  } catch (const Expected&) {
    throw Expected{what};
  }
}

inline void read(const toml::value& from, const Allowed&, std::filesystem::path& to) {
  std::string text;
  readPart("a file's name", from, {}, text);
  to = text;
}

template <int N, class Number>
void read(const toml::value& from, const Allowed& allowed, glm::vec<N, Number>& to) {
  const std::string what = std::to_string(N) + " numbers, each ";
  if (!from.is_array() || from.as_array().size() != N) throw Expected{what + rangeText(allowed)};
  try {
    for (int i = 0; i < N; ++i) read(from.as_array()[static_cast<std::size_t>(i)], allowed, to[i]);
  } catch (const Expected& expected) {
    throw Expected{what + expected.what};
  }
}

/// Names of columns.
template <std::size_t N>
void read(const toml::value& from, const Allowed&, std::array<std::string, N>& to) {
  const std::string what = std::to_string(N) + " names of columns";
  if (!from.is_array() || from.as_array().size() != N) throw Expected{what};
  for (std::size_t i = 0; i < N; ++i) readPart(what, from.as_array()[i], {}, to[i]);
}

/// Names of columns with the values of the rows to read: { participant = "A" }.
inline void read(const toml::value& from, const Allowed&,
                 std::vector<std::pair<std::string, std::string>>& to) {
  const std::string what = "columns and their values, such as { participant = \"A\" }";
  if (!from.is_table()) throw Expected{what};
  to.clear();
  for (const auto& [name, value] : from.as_table()) {
    if (value.is_string()) {
      to.emplace_back(name, toml::get<std::string>(value));
    } else if (value.is_integer()) {
      to.emplace_back(name, std::to_string(value.as_integer()));
    } else {
      throw Expected{what};
    }
  }
  std::ranges::sort(to);  // a TOML table has no order
}

/// A value of an enum, by its word.
template <HasStudyWords Enum>
void read(const toml::value& from, const Allowed& allowed, Enum& to) {
  std::string text;
  read(from, allowed, text);
  for (const auto& word : kStudyWords<Enum>) {
    if (word.text == text) to = word.value;
  }
}

/// A list of words of an enum, each once.
template <HasStudyWords Enum>
void read(const toml::value& from, const Allowed& allowed, std::vector<Enum>& to) {
  std::string what = "a list of";
  for (const auto word : allowed.words) what += " \"" + std::string(word) + "\"";
  if (!from.is_array()) throw Expected{what};
  to.clear();
  for (const toml::value& element : from.as_array()) {
    Enum value{};
    readPart(what, element, allowed, value);
    if (std::ranges::find(to, value) != to.end()) throw Expected{what + ", each once"};
    to.push_back(value);
  }
}

template <class T>
requires(!HasStudyWords<std::optional<T>>) void read(const toml::value& from,
                                                     const Allowed& allowed, std::optional<T>& to) {
  T value{};
  read(from, allowed, value);
  to = value;
}

inline std::string write(double value) { return exactText(value); }
/// The shortest text that reads as this float.
inline std::string write(float value) {
  std::array<char, 40> text;
  return {text.begin(), std::to_chars(text.begin(), text.end(), value).ptr};
}
std::string write(std::signed_integral auto value) { return std::to_string(value); }
inline std::string write(bool value) { return value ? "true" : "false"; }
inline std::string write(const std::string& value) { return quotedText(value); }
inline std::string write(const std::filesystem::path& value) { return quotedText(value.string()); }
/// A list of JSON.
template <class Values>
std::string listOf(const Values& values) {
  std::string text = "[";
  for (const auto& value : values) text += (text.size() > 1 ? ", " : "") + write(value);
  return text + "]";
}
template <int N, class Number>
std::string write(const glm::vec<N, Number>& value) {
  return listOf(std::span(&value.x, N));
}
template <std::size_t N>
std::string write(const std::array<std::string, N>& names) {
  return names[0].empty() ? "null" : listOf(names);
}
inline std::string write(const std::vector<std::pair<std::string, std::string>>& rows) {
  if (rows.empty()) return "null";
  std::string text;
  for (const auto& [name, value] : rows) {
    text += (text.empty() ? "{" : ", ") + quotedText(name) + ": " + quotedText(value);
  }
  return text + "}";
}
template <HasStudyWords Enum>
std::string write(const Enum& value) {
  return quotedText(std::string(studyWord(value)));
}
template <HasStudyWords Enum>
std::string write(const std::vector<Enum>& values) {
  return listOf(values);
}
template <class T>
requires(!HasStudyWords<std::optional<T>>) std::string write(const std::optional<T>& value) {
  return value ? write(*value) : "null";
}

/// A value on one line, of a list at least the first 60 characters.
inline std::string lineOf(const toml::value& value) {
  if (value.is_integer()) return std::to_string(value.as_integer());
  if (value.is_floating()) return exactText(value.as_floating());
  if (value.is_boolean()) return write(value.as_boolean());
  if (value.is_string()) return quotedText(toml::get<std::string>(value));
  if (value.is_table()) return "{...}";
  if (!value.is_array()) return "a date or time";
  std::string text;
  for (const auto& element : value.as_array()) {
    text += (text.empty() ? "" : ", ") + lineOf(element);
    if (text.size() > 60) break;
  }
  return "[" + text + "]";
}

/// A value on one short line, for messages.
inline std::string shownValue(const toml::value& value) {
  const std::string text = lineOf(value);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

// The keys of a study.

using KeyNames = std::set<std::string, std::less<>>;

/// Sets every key of a TOML document.
/// @param file  for messages
/// @return the names of the keys set
/// @throws InputError naming file, line, key and value where the table of keys forbids something
KeyNames setKeys(Study& study, const TomlDocument& document, const std::string& file);

/// Sets one key, which the table must have (asserted). @throws Expected
void setKey(Study& study, std::string_view key, const toml::value& value);

/// Whether a key of the screen decides angles: with it, the study names its screen.
bool decidesAngles(std::string_view key);

/// A text from outside, made printable and short for a message.
std::string shownName(std::string_view name);

}  // namespace foci
