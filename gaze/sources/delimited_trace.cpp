#include "gaze/sources/delimited_trace.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "gaze/focus/line_of_sight.h"

namespace foci {
namespace {

using Fields = std::vector<std::string_view>;

constexpr double kFarthest_px = 1e5;  // no gaze is as far from any screen
constexpr double kWidest_deg = 89.0;  // a flat screen ends before 90
constexpr double kLatest_s = 1e11;    // a clock in seconds keeps 20 us up to here
constexpr double kWidestPupil_mm = 15.0;

constexpr std::string_view kTimeNames[] = {"time",        "timestamp",           "t",
                                           "sample_time", "recording_timestamp", "gaze_timestamp"};
constexpr std::string_view kXNames[] = {"x", "gaze_x", "x_gaze", "gazex", "gaze_point_x", "eye_x"};
constexpr std::string_view kYNames[] = {"y", "gaze_y", "y_gaze", "gazey", "gaze_point_y", "eye_y"};

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// How many single letters lie between two names (Levenshtein).
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string nearestColumn(const Fields& header, std::string_view wanted) {
  constexpr std::size_t kMostColumns = 256, kLongestName = 64;
  std::string_view best;
  std::size_t least = static_cast<std::size_t>(-1);
  for (std::size_t i = 0; i < std::min(header.size(), kMostColumns); ++i) {
    const auto name = header[i].substr(0, kLongestName);
    const std::size_t distance =
        editDistance(lowered(name), lowered(wanted.substr(0, kLongestName)));
    if (distance < least) {
      least = distance;
      best = header[i];
    }
  }
  return shown(best);
}

/// What follows the last "_" of a name, if it is one of the units that we know, else nothing.
std::string_view unitSuffix(std::string_view name) {
  for (std::string_view unit : {"_s", "_ms", "_us", "_ns", "_px", "_deg", "_dva", "_norm"}) {
    if (lowered(name).ends_with(unit)) return unit;
  }
  return {};
}

std::optional<std::size_t> columnNamed(const Fields& header, const std::string& name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

/// The column that is called so or, where no name is given, one of the usual names with or without
/// a unit. @throws InputError where there is none
std::size_t findColumn(const LineReader& lines, const Fields& header, const std::string& name,
                       std::span<const std::string_view> usual) {
  if (!name.empty()) {
    if (const auto column = columnNamed(header, name)) return *column;
    throw lines.error("no column " + shown(name) + ": the nearest is " +
                      nearestColumn(header, name));
  }
  for (std::string_view base : usual) {
    for (std::size_t i = 0; i < header.size(); ++i) {
      const std::string lower = lowered(header[i]);
      const std::string_view without =
          std::string_view(lower).substr(0, lower.size() - unitSuffix(lower).size());
      if (lower == base || without == base) return i;
    }
  }
  throw lines.error("no column " + shown(usual[0]) + ": the nearest is " +
                    nearestColumn(header, usual[0]));
}

std::optional<std::size_t> findOptional(const LineReader& lines, const Fields& header,
                                        const std::string& name,
                                        std::initializer_list<const char*> usual) {
  if (!name.empty()) return findColumn(lines, header, name, {});
  for (const char* each : usual) {
    if (const auto column = columnNamed(header, each)) return column;
  }
  return std::nullopt;
}

std::optional<GazeUnits> unitsNamed(std::string_view name) {
  if (name == "px" || name == "_px" || name == "pixels") return GazeUnits::px;
  if (name == "deg" || name == "_deg" || name == "_dva" || name == "dva" || name == "degrees") {
    return GazeUnits::deg;
  }
  if (name == "normalised" || name == "normalized" || name == "norm" || name == "_norm") {
    return GazeUnits::normalised;
  }
  return std::nullopt;
}

double secondsPer(std::string_view unit) {
  return unit == "_ms" ? 1e-3 : unit == "_us" ? 1e-6 : unit == "_ns" ? 1e-9 : 1.0;
}

/// What the first line says of the recording.
struct Preamble {
  Screen screen;
  std::optional<GazeUnits> units{};
};

/// `# key=value ...`; keys that are not ours are other people's and pass.
Preamble readPreamble(const LineReader& lines, std::string_view line, const Screen& fallback) {
  Preamble result{.screen = fallback};
  Fields words;
  splitWords(line.substr(1), words);
  for (std::string_view word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) continue;
    const auto key = word.substr(0, equals), text = word.substr(equals + 1);
    if (key == "units") {
      result.units = unitsNamed(text);
      if (!result.units) {
        throw lines.error("units = " + shown(text) + ": expected px, deg or normalised");
      }
      continue;
    }
    const auto number = [&](double low, double high, const char* range) {
      const auto value = parseNumber(text);
      if (value && *value >= low && *value <= high) return *value;
      throw lines.error(std::string(key) + " = " + shown(text) + ": expected " + range);
    };
    const auto pixels = [&] { return static_cast<int>(number(16, 16384, "16 to 16384 px")); };
    const auto metres = [&] { return number(0.01, 20.0, "0.01 to 20 m"); };
    if (key == "screen_width_px") result.screen.size_px.x = pixels();
    if (key == "screen_height_px") result.screen.size_px.y = pixels();
    if (key == "screen_width_m") result.screen.size_m.x = metres();
    if (key == "screen_height_m") result.screen.size_m.y = metres();
    if (key == "viewing_distance_m") result.screen.distance_m = metres();
  }
  return result;
}

class TableReader {
 public:
  TableReader(LineReader& lines, const TraceColumns& columns, const Screen& fallback)
      : lines_(lines), preamble_{.screen = fallback} {
    readHeader(columns);
  }

  GazeTrace read() {
    GazeTrace trace{.format = delimiter_ == '\t' ? "TSV" : "CSV", .screen = preamble_.screen};
    std::string_view line;
    while (lines_.next(line)) {
      if (trimmed(line).empty()) continue;
      splitFields(line, delimiter_, fields_);
      const GazeSample sample = readSample();
      if (!trace.samples.empty() && sample.time_s <= trace.samples.back().time_s) {
        throw lines_.error("time " + shown(fields_[time_]) + " is not after the sample before");
      }
      trace.samples.push_back(sample);
    }
    return trace;
  }

 private:
  void readHeader(const TraceColumns& columns) {
    std::string_view line;
    bool found = false;
    while (!found && lines_.next(line)) {
      if (line.starts_with('#')) preamble_ = readPreamble(lines_, line, preamble_.screen);
      found = !trimmed(line).empty() && !line.starts_with('#');
    }
    if (!found) throw InputError(lines_.fileName(), "empty: expected a header line and samples");
    const auto has = [&](char c) { return line.find(c) != std::string_view::npos; };
    delimiter_ = has('\t') ? '\t' : has(';') ? ';' : ',';
    splitFields(line, delimiter_, fields_);

    time_ = findColumn(lines_, fields_, columns.time, kTimeNames);
    x_ = findColumn(lines_, fields_, columns.x, kXNames);
    y_ = findColumn(lines_, fields_, columns.y, kYNames);
    pupil_ = findOptional(lines_, fields_, columns.pupil, {"pupil_mm", "pupil_diameter_mm"});
    blink_ = findOptional(lines_, fields_, columns.blink, {"blink", "is_blink"});

    time_scale_s_ = columns.time_scale_s.value_or(secondsPer(unitSuffix(fields_[time_])));
    const auto x_units = unitsNamed(unitSuffix(fields_[x_]));
    if (!columns.units && !preamble_.units && x_units != unitsNamed(unitSuffix(fields_[y_]))) {
      throw lines_.error("columns " + shown(fields_[x_]) + " and " + shown(fields_[y_]) +
                         " have different units: expected the same");
    }
    units_ = columns.units     ? *columns.units
             : preamble_.units ? *preamble_.units
                               : x_units.value_or(GazeUnits::px);
    const Screen& screen = preamble_.screen;
    if (units_ != GazeUnits::px && !(screen.size_px.x > 0 && screen.size_px.y > 0)) {
      throw lines_.error("the screen is not known in pixels: give its size");
    }
    if (units_ == GazeUnits::deg &&
        !(screen.size_m.x > 0.0 && screen.size_m.y > 0.0 && screen.distance_m > 0.0)) {
      throw lines_.error("degrees need a screen: give its size and distance in metres");
    }
  }

  GazeSample readSample() const {
    const auto time = parseNumber(field(time_));
    if (!time || !(std::abs(*time * time_scale_s_) <= kLatest_s)) fail(time_, "expected a time");
    GazeSample sample{.time_s = *time * time_scale_s_};
    if (!isAbsent(field(x_)) && !isAbsent(field(y_))) sample.point_px = readPoint();
    if (pupil_ && !isAbsent(field(*pupil_))) {
      const auto pupil = parseNumber(field(*pupil_));
      if (!pupil || *pupil > kWidestPupil_mm) fail(*pupil_, "expected a diameter up to 15 mm");
      if (*pupil > 0.0) sample.pupil_mm = pupil;
    }
    if (blink_) {
      sample.blink = readFlag(*blink_);
      if (sample.blink) sample.point_px.reset();
    }
    return sample;
  }

  glm::dvec2 readPoint() const {
    glm::dvec2 point;
    const Screen& screen = preamble_.screen;
    const double limit = units_ == GazeUnits::px ? kFarthest_px
                         : units_ == GazeUnits::deg
                             ? kWidest_deg
                             : kFarthest_px / glm::max(screen.size_px.x, screen.size_px.y);
    for (int axis : {0, 1}) {
      const std::size_t column = axis == 0 ? x_ : y_;
      const auto value = parseNumber(field(column));
      if (!value) fail(column, "expected a number");
      if (std::abs(*value) > limit) fail(column, "too far from any screen");
      point[axis] = *value;
    }
    if (units_ == GazeUnits::deg) return pointAtEccentricity_px(screen, point);
    return units_ == GazeUnits::normalised ? point * glm::dvec2(screen.size_px) : point;
  }

  bool readFlag(std::size_t column) const {
    const std::string_view text = field(column);
    if (isAbsent(text) || lowered(text) == "false") return false;
    if (lowered(text) == "true") return true;
    const auto value = parseNumber(text);
    if (!value) fail(column, "expected 0 or 1");
    return *value != 0.0;
  }

  std::string_view field(std::size_t column) const {
    if (column < fields_.size()) return fields_[column];
    throw lines_.error(std::to_string(fields_.size()) + " fields: expected " +
                       std::to_string(column + 1) + " at least");
  }

  [[noreturn]] void fail(std::size_t column, const char* expected) const {
    throw lines_.error("column " + std::to_string(column + 1) + " = " + shown(field(column)) +
                       ": " + expected);
  }

  LineReader& lines_;
  Preamble preamble_;
  Fields fields_;
  char delimiter_ = ',';
  std::size_t time_ = 0, x_ = 0, y_ = 0;
  std::optional<std::size_t> pupil_, blink_;
  double time_scale_s_ = 1.0;
  GazeUnits units_ = GazeUnits::px;
};

}  // namespace

GazeTrace readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                             const Screen& fallback_screen) {
  return TableReader(lines, columns, fallback_screen).read();
}

}  // namespace foci
