#include "gaze/sources/column_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/nearest.h"
#include "base/number.h"
#include "base/text.h"

namespace foci {
namespace {

bool isUnit(std::string_view word) {
  for (const std::string_view unit :
       {"s", "ms", "us", "ns", "px", "deg", "dva", "norm", "mm", "m"}) {
    if (word == unit) return true;
  }
  return false;
}

}  // namespace

ColumnNames::Name ColumnNames::nameOf(std::string_view text) {
  std::string lower;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool micro =
        text.substr(i).starts_with("\xce\xbc") || text.substr(i).starts_with("\xc2\xb5");
    lower += micro ? 'u' : static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    i += micro;
  }
  Name name;
  const std::size_t bracket = lower.find_first_of("[(");
  if (bracket != std::string::npos && bracket > 0) {
    std::string inside = lower.substr(bracket + 1);
    inside.erase(
        std::find_if(inside.begin(), inside.end(), [](char c) { return c == ']' || c == ')'; }),
        inside.end());
    // Tobii writes "DACS px", "ADCSpx", "MCSnorm": the unit is the end of the word.
    for (const std::string_view unit : {"px", "norm", "deg", "mm", "ms", "us", "ns", "s"}) {
      if (name.unit.empty() && inside.ends_with(unit)) name.unit = unit;
    }
    lower.resize(bracket);
  } else if (const std::size_t at = lower.rfind('_');
             at != std::string::npos && at > 0 && isUnit(lower.substr(at + 1))) {
    name.unit = lower.substr(at + 1);
    lower.resize(at);
  }
  for (const char c : lower) {
    if (std::isalnum(static_cast<unsigned char>(c))) name.key += c;
  }
  return name;
}

ColumnNames::ColumnNames(const LineReader& lines, std::string_view header, char delimiter)
    : lines_(lines) {
  constexpr std::size_t kMaxColumns = 4096;
  splitRow(header, delimiter, texts_);
  if (texts_.size() > kMaxColumns) throw lines.error("over 4096 columns");
  for (const std::string_view text : texts_) names_.push_back(nameOf(text));
}

std::optional<std::size_t> ColumnNames::find(Keys keys) const {
  for (const std::string_view key : keys) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].key == key) return i;
    }
  }
  return std::nullopt;
}

std::size_t ColumnNames::named(const std::string& name) const {
  const auto found = std::find(texts_.begin(), texts_.end(), name);
  if (found != texts_.end()) return static_cast<std::size_t>(found - texts_.begin());
  if (name.starts_with('#')) {
    const auto number = parseNumber(std::string_view(name).substr(1));
    if (number && *number >= 1.0 && *number <= static_cast<double>(size()) &&
        *number == std::floor(*number)) {
      return static_cast<std::size_t>(*number) - 1;
    }
    throw lines_.error("no column " + shown(name) + ": expected #1 to #" + std::to_string(size()));
  }
  throw lines_.error("no column " + shown(name) + ": the nearest is " + nearestTo(name));
}

std::size_t ColumnNames::require(const std::string& name, Keys keys) const {
  if (!name.empty()) return named(name);
  if (const auto found = find(keys)) return *found;
  throw lines_.error("no column " + shown(keys[0]) + ": the nearest is " + nearestTo(keys[0]));
}

std::string ColumnNames::nearestTo(std::string_view wanted) const {
  std::vector<std::string> known;
  for (const std::string_view text : texts_) known.emplace_back(text.substr(0, 64));
  return shown(nearest(wanted, known));
}

}  // namespace foci
