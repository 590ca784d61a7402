#include "gaze/sources/column_names.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <utility>

#include "base/nearest.h"
#include "base/text.h"

namespace foci {
namespace {

/// Names of angles whose unit is not told.
constexpr std::string_view kAngles =
    "yaw pitch gazeyaw gazepitch azimuth elevation gazeazimuth gazeelevation";

/// What stands in brackets and is no unit, if any of its words is one of these.
constexpr std::string_view kNoUnits =
    "left right both eye eyes l r od os ou x y horizontal vertical raw filtered smoothed corrected "
    "calibrated interpolated mean average avg median best combined cyclopean screen display "
    "monitor gaze position abs absolute";

bool mayBeUnit(std::string_view inside) {
  const auto words = wordsOf(inside, " ");
  return !isAbsent(inside) && inside.find_first_of("0123456789:") == inside.npos &&
         std::ranges::none_of(words,
                              [](std::string_view word) { return isWordOf(kNoUnits, word); });
}

/// Removes the word for fractions from a key. @return whether it was there
bool takeNorm(std::string& key) {
  for (const std::string_view word : {"normalised", "normalized", "norm"}) {
    const std::size_t at = key.find(word);
    if (at == std::string::npos || key.size() == word.size()) continue;
    // "normal" is a direction in space.
    if (word == "norm" && key.compare(at, 6, "normal") == 0) continue;
    key.erase(at, word.size());
    return true;
  }
  return false;
}

/// In lower case, with u for the sign of micro.
std::string spelledPlainly(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool micro =
        text.substr(i).starts_with("\xce\xbc") || text.substr(i).starts_with("\xc2\xb5");
    plain += micro ? 'u' : lowered(text[i]);
    i += micro;
  }
  return plain;
}

}  // namespace

ColumnNames::Name ColumnNames::nameOf(std::string_view text) {
  std::string lower = spelledPlainly(text);
  Name name;
  const std::size_t bracket = lower.find_first_of("[(");
  if (bracket != std::string::npos && bracket > 0) {
    std::string inside = lower.substr(bracket + 1);
    inside.erase(std::ranges::find_if(inside, [](char c) { return c == ']' || c == ')'; }),
                 inside.end());
    name.unit = unitIn(inside);
    if (name.unit.empty() && mayBeUnit(inside)) name.unknown_unit = inside;
    name.of_media = inside.starts_with("mcs");
    lower.resize(bracket);
  } else if (const std::size_t at = lower.rfind('_'); at != std::string::npos && at > 0) {
    name.unit = shortUnit(std::string_view(lower).substr(at + 1));
    if (!name.unit.empty()) lower.resize(at);
  }
  for (const char c : lower) {
    if (std::isalnum(static_cast<unsigned char>(c))) name.key += c;
  }
  if (name.unit.empty() && takeNorm(name.key)) name.unit = "norm";
  return name;
}

ColumnNames::ColumnNames(const Place& place, const std::vector<std::string>& names)
    : place_(place), texts_(names.begin(), names.end()) {
  constexpr std::size_t kMaxColumns = 4096;
  if (texts_.size() > kMaxColumns) throw place.error("over 4096 columns");
  for (const std::string_view text : texts_) names_.push_back(nameOf(text));
}

std::string shortUnit(std::string_view word) {
  static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"s", "s sec secs second seconds"},
      {"ms", "ms msec msecs millisecond milliseconds"},
      {"us", "us usec usecs microsecond microseconds"},
      {"ns", "ns nsec nsecs nanosecond nanoseconds"},
      {"px", "px pix pixel pixels"},
      {"deg", "deg degs dva degree degrees \xc2\xb0 \xc2\xba"},
      {"arcmin", "arcmin arcmins arcminute arcminutes"},
      {"mrad", "mrad milliradian milliradians"},
      {"norm", "norm normalised normalized"},
      {"mm", "mm millimeter millimeters millimetre millimetres"},
      {"cm", "cm"},
      {"m", "m meter meters metre metres"},
      {"rad", "rad radian radians"},
      {"%", "% percent pct"},
      {"a.u.", "a.u. au arbitrary"}};
  for (const auto& [unit, words] : kUnits) {
    if (isWordOf(words, word)) return std::string(unit);
  }
  return {};
}

std::string unitIn(std::string_view text) {
  if (text.starts_with("arc min") || text.ends_with("minutes of arc")) return "arcmin";
  const std::string_view last = text.substr(text.rfind(' ') + 1);
  if (std::string unit = shortUnit(last); !unit.empty()) return unit;
  // Only in brackets: "x_min" is a minimum.
  if (last == "min" || last == "minutes") return "min";
  if (last == "h" || last == "hours") return "h";
  if (isWordOf("in inch inches", last)) return "in";
  const std::string first = shortUnit(text.substr(0, text.find(' ')));
  if (text.ends_with("visual angle") && (text.starts_with("visual") || !first.empty())) {
    return first.empty() ? "deg" : first;
  }
  for (const std::string_view unit : {"px", "norm", "mm"}) {
    if (last.ends_with(unit)) return std::string(unit);
  }
  return {};
}

double degreesPer(std::string_view unit) {
  static const std::pair<std::string_view, double> kDegrees[] = {{"deg", 1.0},
                                                                 {"arcmin", 1.0 / 60.0},
                                                                 {"mrad", 1e-3 * glm::degrees(1.0)},
                                                                 {"rad", glm::degrees(1.0)}};
  for (const auto& [name, degrees] : kDegrees) {
    if (unit == name) return degrees;
  }
  return 0.0;
}

double ColumnNames::secondsPerUnit(std::size_t column) const {
  static constexpr std::pair<std::string_view, double> kSeconds[] = {
      {"h", 3600.0}, {"min", 60.0}, {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
  for (const auto& [name, seconds] : kSeconds) {
    if (unit(column) == name) return seconds;
  }
  return 0.0;
}

std::string keysOf(std::string_view pattern, std::size_t side, char axis) {
  const std::string eye = side == 0 ? "left" : "right";
  std::string keys;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    if (pattern.substr(at).starts_with("EYE")) {
      keys += eye;
      at += 2;
    } else if (pattern[at] == 'E') {
      keys += eye[0];
    } else {
      keys += pattern[at] == 'A' ? axis : pattern[at];
    }
  }
  return keys;
}

std::string listOf(const std::vector<std::string>& values) {
  constexpr std::size_t kMaxListed = 6;
  const std::string text =
      listed(std::span(values).first(std::min(values.size(), kMaxListed)), ", ", shown);
  return values.size() > kMaxListed ? text + ", ..." : text;
}

bool isWordOf(std::string_view words, std::string_view word) {
  for (std::size_t at = words.find(word); !word.empty() && at != words.npos;
       at = words.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' '))
      return true;
  }
  return false;
}

template <class Wanted>
std::optional<std::size_t> ColumnNames::findIf(std::string_view keys, const Wanted& wanted) const {
  while (!keys.empty()) {
    const std::string_view key = keys.substr(0, keys.find(' '));
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].key == key && wanted(i)) return i;
    }
    keys.remove_prefix(std::min(key.size() + 1, keys.size()));
  }
  return std::nullopt;
}

std::optional<std::size_t> ColumnNames::find(std::string_view keys) const {
  return findIf(keys, [](std::size_t) { return true; });
}

std::optional<std::size_t> ColumnNames::findPosition(std::string_view keys) const {
  return findIf(keys, [&](std::size_t column) {
    return !names_[column].of_media && (unit(column).empty() || isWordOf("px norm", unit(column)) ||
                                        degreesPer(unit(column)) > 0.0);
  });
}

std::optional<std::array<std::size_t, 3>> ColumnNames::findTriple(std::string_view pattern,
                                                                  std::size_t side) const {
  std::array<std::size_t, 3> columns{};
  for (const std::size_t axis : {0, 1, 2}) {
    const auto column = find(keysOf(pattern, side, "xyz"[axis]));
    if (!column) return std::nullopt;
    columns[axis] = *column;
  }
  return columns;
}

bool ColumnNames::isNamed(std::size_t column) const {
  return std::ranges::find(named_, column) != named_.end();
}

std::size_t ColumnNames::at(const std::string& name) const {
  const auto found = std::ranges::find(texts_, name);
  if (found != texts_.end()) return static_cast<std::size_t>(found - texts_.begin());
  if (name.starts_with('#')) {
    const auto number = parseNumber(std::string_view(name).substr(1));
    if (number && *number >= 1.0 && *number <= static_cast<double>(size()) &&
        *number == std::floor(*number)) {
      return static_cast<std::size_t>(*number) - 1;
    }
    throw place_.error("no column " + shown(name) + ": expected #1 to #" + std::to_string(size()));
  }
  throw place_.error("no column " + shown(name) + ": " + nearestTo(name));
}

void ColumnNames::refuseTwin(std::size_t column) const {
  if (texts_[column].empty() || std::ranges::count(texts_, texts_[column]) == 1) {
    return;
  }
  throw place_.error("two columns " + shown(texts_[column]) +
                     ": give the one that is meant by its number, such as gaze.x = \"#" +
                     std::to_string(column + 1) + "\"");
}

/// Whether the name hints at the meaning. Axes come in pairs: "LPOGX" is one of "LPOGX", "LPOGY".
bool ColumnNames::mayBe(Meaning meaning, std::size_t column) const {
  const std::string lower = spelledPlainly(texts_[column]);
  const auto has = [&](std::string_view part) { return lower.find(part) != std::string::npos; };
  if (meaning == Meaning::time) {
    const std::string& unit = names_[column].unit;
    return has("time") || has("stamp") || has("clock") || has("tick") ||
           isWordOf("s ms us ns", unit);
  }
  if (has(meaning == Meaning::x ? "horiz" : "vert")) return true;
  if (has(meaning == Meaning::x ? "azimuth" : "elevation")) return true;
  const char axis = meaning == Meaning::x ? 'x' : 'y', other = meaning == Meaning::x ? 'y' : 'x';
  for (std::size_t at = lower.find(axis); at != std::string::npos; at = lower.find(axis, at + 1)) {
    std::string pair = lower;
    pair[at] = other;
    if (std::ranges::find(texts_, pair, spelledPlainly) != texts_.end()) return true;
  }
  return false;
}

/// The names of the wanted columns, up to six.
template <class Wanted>
std::string ColumnNames::listed(const Wanted& wanted) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    if (wanted(i)) names.emplace_back(texts_[i]);
  }
  return listOf(names);
}

/// What a table is that has no samples of gaze as its rows; empty if that cannot be told.
std::string ColumnNames::otherKind() const {
  const auto namesWith = [&](std::initializer_list<std::string_view> parts) {
    return listed([&](std::size_t i) {
      return std::ranges::any_of(parts, [&](std::string_view part) {
        return names_[i].key.find(part) != std::string::npos;
      });
    });
  };
  if (!namesWith({"webgazerdata"}).empty()) {
    return "the column webgazer_data holds the samples of a trial as JSON: write them as a table, "
           "t, x and y of a sample in each row";
  }
  if (find("fixationx fixationpointx starttimestamp")) {
    return "the rows are fixations or events: export the samples of gaze";
  }
  if (const std::string directions =
          namesWith({"gazedirect", "gazevector", "gazedir", "gvec", "raydirection", "gazeforward",
                     "leftdirection", "rightdirection", "eyedir"});
      !directions.empty()) {
    return "the columns " + directions +
           " are directions in space: name x, y and z in a study with gaze.direction = [...], and "
           "set gaze.axes and gaze.frame";
  }
  const auto isAngle = [&](std::size_t i) { return isWordOf(kAngles, names_[i].key); };
  if (const std::string angles = listed(isAngle); !angles.empty()) {
    return "the columns " + angles +
           " are angles: name them in a study with gaze.angles = [to the right, upwards], or with "
           "gaze.x, gaze.y and gaze.units = \"deg\" for an eye before a screen";
  }
  return "";
}

InputError ColumnNames::missing(Meaning meaning, std::string_view keys) const {
  const std::string option = meaning == Meaning::time ? "time" : meaning == Meaning::x ? "x" : "y";
  const std::string what = "no column " + shown(option) + ": ";
  if (!texts_.empty() && parseNumber(texts_[0])) {
    return place_.error(what + "the first line has numbers, not names; give columns by number: " +
                        "gaze.time = \"#1\", gaze.x = \"#2\", gaze.y = \"#3\"");
  }
  if (const auto wrong = find(keys); wrong && meaning != Meaning::time) {
    const std::string column = "column " + shown(texts_[*wrong]);
    return place_.error(
        names_[*wrong].of_media
            ? column +
                  " counts from the presented media: expected positions on the screen (DACS "
                  "px, ADCSpx); export them, or name the column with gaze." +
                  option
            : column + " is in " + shown(names_[*wrong].unit) +
                  ": expected px, deg or fractions of the screen; gaze.scale converts it, with "
                  "gaze.units and gaze." +
                  option);
  }
  if (const std::string other = otherKind(); !other.empty()) return place_.error(other);
  if (equalsIgnoringCase(texts_[0], "@relation")) {
    return place_.error(
        "ARFF: expected names in the first line: replace the lines up to @data by the names of the "
        "attributes, separated by commas");
  }
  if (texts_.size() == 1 && texts_[0].find('|') != std::string_view::npos) {
    return place_.error(
        "fields separated by \"|\": expected tabs, semicolons, commas or blanks; or "
        "begin the file with the line sep=|");
  }
  const std::string how = "name it with gaze." + option + "; ";
  const std::string candidates = listed([&](std::size_t i) { return mayBe(meaning, i); });
  if (!candidates.empty()) return place_.error(what + how + "it may be " + candidates);
  const std::string all = listed([](std::size_t) { return true; });
  const std::string known = listed([&](std::size_t i) {
    return mayBe(Meaning::time, i) || mayBe(Meaning::x, i) || mayBe(Meaning::y, i);
  });
  const char* const else_where =
      known.empty() ? "; if the names are in a later line, remove the lines before it, or begin "
                      "them with #"
      : meaning == Meaning::time ? "; if none has the time, give gaze.rate_Hz"
                                 : "";
  return place_.error(what + how + "the columns are " + all + else_where);
}

std::string ColumnNames::nearestTo(std::string_view wanted) const {
  std::vector<std::string> known;
  for (const std::string_view text : texts_) known.emplace_back(text.substr(0, 64));
  if (const auto near = nearWord(wanted, known)) return "the nearest is " + shown(*near);
  return "the columns are " + listed([](std::size_t) { return true; });
}

}  // namespace foci
