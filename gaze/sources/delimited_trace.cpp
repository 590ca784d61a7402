#include "gaze/sources/delimited_trace.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "gaze/focus/line_of_sight.h"
#include "gaze/sources/cyclopean.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace {

using Fields = std::vector<std::string_view>;

constexpr double kFarthest_px = 1e5;  // no gaze is as far from any screen
constexpr double kWidest_deg = 89.0;  // a flat screen ends before 90
constexpr double kLatest_s = 1e11;    // a clock in seconds keeps 20 us up to here
constexpr double kWidestPupil_mm = 15.0;
constexpr double kConfident = 0.6;  // as Pupil's own software takes it

// Degrees and fractions keep their meaning on any screen: on this one where none is known.
const Screen kNominalScreen{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};

bool isMetric(const Screen& screen) {
  return screen.size_px.x > 0 && screen.size_px.y > 0 && screen.size_m.x > 0.0 &&
         screen.size_m.y > 0.0 && screen.distance_m > 0.0;
}

/// What the lines before the table say of the recording.
struct Preamble {
  Screen screen{};
  std::optional<GazeUnits> units{};
  bool smi = false;
};

double numberIn(const LineReader& lines, std::string_view key, std::string_view text, double low,
                double high, const char* range) {
  const auto value = parseNumber(text);
  if (value && *value >= low && *value <= high) return *value;
  throw lines.error(std::string(key) + " = " + shown(text) + ": expected " + range);
}

/// `# key=value ...`; keys that are not ours are other people's and pass.
void readKeys(const LineReader& lines, std::string_view line, Preamble& result) {
  Fields words;
  splitWords(line.substr(1), words);
  for (const std::string_view word : words) {
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
    const auto pixels = [&] {
      return static_cast<int>(numberIn(lines, key, text, 16, 16384, "16 to 16384 px"));
    };
    const auto metres = [&] { return numberIn(lines, key, text, 0.01, 20.0, "0.01 to 20 m"); };
    if (key == "screen_width_px") result.screen.size_px.x = pixels();
    if (key == "screen_height_px") result.screen.size_px.y = pixels();
    if (key == "screen_width_m") result.screen.size_m.x = metres();
    if (key == "screen_height_m") result.screen.size_m.y = metres();
    if (key == "viewing_distance_m") result.screen.distance_m = metres();
  }
}

/// BeGaze: `## Calibration Area:<tab>1680<tab>1050` and the like, lengths in millimetres.
void readSmi(const LineReader& lines, std::string_view line, Preamble& result) {
  Fields fields;
  splitFields(line, '\t', fields);
  const auto starts = [&](std::string_view key) {
    return fields[0].find(key) != std::string_view::npos;
  };
  result.smi |= starts("BeGaze") || starts("iView") || starts("Calibration Area");
  const auto value = [&](std::size_t i, double low, double high, const char* range) {
    return numberIn(lines, trimmed(fields[0].substr(2)), fields[i], low, high, range);
  };
  if (starts("Calibration Area") && fields.size() >= 3) {
    result.screen.size_px = {static_cast<int>(value(1, 16, 16384, "16 to 16384 px")),
                             static_cast<int>(value(2, 16, 16384, "16 to 16384 px"))};
  } else if (starts("Stimulus Dimension") && fields.size() >= 3) {
    result.screen.size_m = 1e-3 * glm::dvec2(value(1, 10, 20000, "10 to 20000 mm"),
                                             value(2, 10, 20000, "10 to 20000 mm"));
  } else if (starts("Head Distance") && fields.size() >= 2) {
    result.screen.distance_m = 1e-3 * value(1, 10, 20000, "10 to 20000 mm");
  }
}

bool isWord(std::string_view text, std::string_view lower) {
  return std::equal(text.begin(), text.end(), lower.begin(), lower.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

class TableReader {
 public:
  TableReader(LineReader& lines, const TraceColumns& columns, const Screen& fallback,
              const TakeSample& take, const std::string& header)
      : lines_(lines), take_(take), preamble_{.screen = fallback} {
    readHeader(columns, header);
  }

  TraceHeader read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (trimmed(line).empty()) continue;
      if (broken_) throw lines_.error("follows a line that is too short");
      splitFields(line, layout_.delimiter, fields_, layout_.columns);
      // A recording that was cut off ends within a line.
      if ((broken_ = fields_.size() < layout_.columns && taken_ > 1 && !layout_.kind)) continue;
      ++taken_;
      if (layout_.kind && field(*layout_.kind) != layout_.sample_kind) continue;
      readResolution();
      hold(readSample());
    }
    settleClock();
    TraceHeader header{.format = layout_.format, .screen = preamble_.screen};
    if (eyes_seen_[0] && eyes_seen_[1]) header.format += ", binocular";
    return header;
  }

 private:
  void readHeader(const TraceColumns& columns, const std::string& given) {
    std::string_view line = given;
    bool found = !given.empty();
    while (!found && lines_.next(line)) {
      if (line.starts_with("##")) {
        readSmi(lines_, line, preamble_);
      } else if (line.starts_with('#')) {
        readKeys(lines_, line, preamble_);
      }
      found = !trimmed(line).empty() && !line.starts_with('#');
    }
    if (!found) throw InputError(lines_.fileName(), "empty: expected a header line and samples");
    layout_ = recogniseTable(lines_, line, columns, preamble_.smi);
    units_ = columns.units     ? *columns.units
             : preamble_.units ? *preamble_.units
                               : layout_.units.value_or(GazeUnits::px);
    Screen& screen = preamble_.screen;
    if ((units_ == GazeUnits::deg || hasDirections()) && !isMetric(screen)) screen = kNominalScreen;
    if (units_ == GazeUnits::normalised && !(screen.size_px.x > 0 && screen.size_px.y > 0)) {
      screen.size_px = kNominalScreen.size_px;
    }
    clock_known_ = layout_.time_scale_s > 0.0;
  }

  bool hasDirections() const {
    return layout_.eyes[0].direction[0] || layout_.eyes[1].direction[0];
  }

  void readResolution() {
    if (!layout_.width_px || !layout_.height_px || resolution_known_) return;
    const auto width = parseNumber(field(*layout_.width_px));
    const auto height = parseNumber(field(*layout_.height_px));
    if (!width || !height) return;
    const auto pixels = [&](std::size_t column) {
      return static_cast<int>(
          numberIn(lines_, "resolution", field(column), 16, 16384, "16 to 16384 px"));
    };
    preamble_.screen.size_px = {pixels(*layout_.width_px), pixels(*layout_.height_px)};
    resolution_known_ = true;
  }

  GazeSample readSample() {
    const auto time = number(layout_.time);
    if (!time || std::abs(*time) * std::max(layout_.time_scale_s, 1e-9) > kLatest_s) {
      fail(layout_.time, "expected a time");
    }
    GazeSample sample{.time_s = *time};  // in the file's unit, until the clock is settled
    if (layout_.confidence && !isAbsent(field(*layout_.confidence))) {
      const auto confidence = number(*layout_.confidence);
      if (!confidence) fail(*layout_.confidence, "expected a number");
      sample.confidence = std::clamp(*confidence, 0.0, 1.0);
    }
    const bool valid = (!sample.confidence || *sample.confidence >= kConfident) &&
                       (!layout_.validity || isValid(*layout_.validity));
    if (valid) {
      if (layout_.has_eyes) {
        for (std::size_t side : {0, 1}) readEye(layout_.eyes[side], sample.eyes[side]);
      }
      if (hasDirections()) {
        sample.point_px = meanSight(sample.eyes);
      } else if (layout_.x) {
        sample.point_px = readPoint(*layout_.x, *layout_.y);
      } else {
        sample.point_px = cyclopean_.combine(*time * (clock_known_ ? layout_.time_scale_s : 0.0),
                                             sample.eyes[0].point_px, sample.eyes[1].point_px);
      }
    }
    sample.pupil_mm = layout_.pupil_mm ? readPupil(*layout_.pupil_mm) : meanPupil(sample.eyes);
    if (layout_.uncertainty_deg && !isAbsent(field(*layout_.uncertainty_deg))) {
      const auto uncertainty_deg = number(*layout_.uncertainty_deg);
      if (!uncertainty_deg || *uncertainty_deg < 0.0 || *uncertainty_deg > 45.0) {
        fail(*layout_.uncertainty_deg, "expected 0 to 45 degrees");
      }
      sample.uncertainty_deg = uncertainty_deg;
    }
    if (layout_.blink) {
      sample.blink =
          layout_.named_blink ? !isAbsent(field(*layout_.blink)) : readFlag(*layout_.blink);
      if (sample.blink) sample.point_px.reset();
    }
    for (std::size_t side : {0, 1}) {
      eyes_seen_[side] |= sample.eyes[side].point_px || sample.eyes[side].direction;
    }
    return sample;
  }

  void readEye(const EyeColumns& columns, EyeSample& eye) {
    if (columns.validity && !isValid(*columns.validity)) return;
    if (columns.point) {
      eye.point_px = readTuple(*columns.point);
    } else if (columns.x && columns.y) {
      eye.point_px = readPoint(*columns.x, *columns.y);
    }
    if (columns.pupil_mm) eye.pupil_mm = readPupil(*columns.pupil_mm);
    // Pupil's camera: x right, y down, z forward, millimetres.
    const auto triple = [&](const auto& at) -> std::optional<glm::dvec3> {
      if (!at[0] || !at[1] || !at[2]) return std::nullopt;
      glm::dvec3 result;
      for (int axis : {0, 1, 2}) {
        const std::size_t column = *at[static_cast<std::size_t>(axis)];
        if (isAbsent(field(column))) return std::nullopt;
        const auto value = number(column);
        if (!value) fail(column, "expected a number");
        result[axis] = axis == 0 ? *value : -*value;
      }
      return result;
    };
    if (const auto direction = triple(columns.direction)) {
      const double length = glm::length(*direction);
      if (length > 0.5 && length < 2.0) eye.direction = *direction / length;
    }
    if (const auto origin_mm = triple(columns.origin_mm)) eye.origin_m = 1e-3 * *origin_mm;
  }

  std::optional<glm::dvec2> meanSight(const std::array<EyeSample, 2>& eyes) const {
    glm::dvec3 sum{0.0};
    for (const EyeSample& eye : eyes) sum += eye.direction.value_or(glm::dvec3(0.0));
    if (!(glm::length(sum) > 0.5)) return std::nullopt;
    const auto point = pointOnScreen_px(preamble_.screen, glm::normalize(sum));
    return point && glm::length(*point) <= kFarthest_px ? point : std::nullopt;
  }

  static std::optional<double> meanPupil(const std::array<EyeSample, 2>& eyes) {
    if (eyes[0].pupil_mm && eyes[1].pupil_mm) return 0.5 * (*eyes[0].pupil_mm + *eyes[1].pupil_mm);
    return eyes[0].pupil_mm ? eyes[0].pupil_mm : eyes[1].pupil_mm;
  }

  bool isValid(std::size_t column) const {
    const std::string_view text = field(column);
    if (isWord(text, "valid") || isWord(text, "true")) return true;
    const auto value = number(column);
    if (!value) return false;
    switch (layout_.validity_code) {
      case ValidityCode::one:
        return *value == 1.0;
      case ValidityCode::zero:
        return *value == 0.0;
      case ValidityCode::below_two:
        return *value >= 0.0 && *value < 2.0;
    }
    return false;
  }

  std::optional<double> readPupil(std::size_t column) const {
    if (isAbsent(field(column))) return std::nullopt;
    const auto pupil_mm = number(column);
    if (!pupil_mm || *pupil_mm > kWidestPupil_mm) fail(column, "expected a diameter up to 15 mm");
    return *pupil_mm > 0.0 ? pupil_mm : std::nullopt;
  }

  std::optional<glm::dvec2> readPoint(std::size_t x, std::size_t y) const {
    if (isAbsent(field(x)) || isAbsent(field(y))) return std::nullopt;
    return pointOf(coordinate(x, field(x)), coordinate(y, field(y)));
  }

  /// "(x, y)".
  std::optional<glm::dvec2> readTuple(std::size_t column) const {
    std::string_view text = field(column);
    if (isAbsent(text)) return std::nullopt;
    const std::size_t comma = text.find(',');
    if (!text.starts_with('(') || !text.ends_with(')') || comma == std::string_view::npos) {
      fail(column, "expected (x, y)");
    }
    const auto x = trimmed(text.substr(1, comma - 1));
    const auto y = trimmed(text.substr(comma + 1, text.size() - comma - 2));
    if (isAbsent(x) || isAbsent(y)) return std::nullopt;
    return pointOf(coordinate(column, x), coordinate(column, y));
  }

  double coordinate(std::size_t column, std::string_view text) const {
    const double limit =
        units_ == GazeUnits::px ? kFarthest_px
        : units_ == GazeUnits::deg
            ? kWidest_deg
            : kFarthest_px / glm::max(preamble_.screen.size_px.x, preamble_.screen.size_px.y);
    const auto value = parse(text);
    if (!value) fail(column, "expected a number");
    if (std::abs(*value) > limit) fail(column, "too far from any screen");
    return *value;
  }

  std::optional<glm::dvec2> pointOf(double x, double y) const {
    if (layout_.zero_is_absent && x == 0.0 && y == 0.0) return std::nullopt;
    const Screen& screen = preamble_.screen;
    if (units_ == GazeUnits::deg) return pointAtEccentricity_px(screen, {x, y});
    if (units_ == GazeUnits::px) return glm::dvec2(x, y);
    return glm::dvec2(x, layout_.y_up ? 1.0 - y : y) * glm::dvec2(screen.size_px);
  }

  bool readFlag(std::size_t column) const {
    const std::string_view text = field(column);
    if (isAbsent(text) || isWord(text, "false")) return false;
    if (isWord(text, "true")) return true;
    const auto value = number(column);
    if (!value) fail(column, "expected 0 or 1");
    return *value != 0.0;
  }

  std::string_view field(std::size_t column) const {
    if (column < fields_.size()) return fields_[column];
    throw lines_.error(std::to_string(fields_.size()) + " fields: expected " +
                       std::to_string(column + 1) + " at least");
  }

  std::optional<double> number(std::size_t column) const { return parse(field(column)); }

  /// Some vendors write the decimal comma of the user's country.
  std::optional<double> parse(std::string_view text) const {
    if (layout_.delimiter == ',' || text.find(',') == std::string_view::npos) {
      return parseNumber(text);
    }
    std::string pointed(text.substr(0, 64));
    std::replace(pointed.begin(), pointed.end(), ',', '.');
    return parseNumber(pointed);
  }

  [[noreturn]] void fail(std::size_t column, const char* expected) const {
    throw lines_.error("column " + std::to_string(column + 1) + " = " + shown(field(column)) +
                       ": " + expected);
  }

  /// Checks the order, and passes samples on once the unit of time is known.
  void hold(GazeSample&& sample) {
    if (last_time_ && sample.time_s <= *last_time_) {
      throw lines_.error("time " + shown(field(layout_.time)) + " is not after the sample before");
    }
    last_time_ = sample.time_s;
    if (clock_known_) {
      sample.time_s *= layout_.time_scale_s;
      take_(sample);
      return;
    }
    constexpr std::size_t kEnough = 128;  // to know the usual interval
    held_.push_back(sample);
    if (held_.size() == kEnough) settleClock();
  }

  void settleClock() {
    if (!clock_known_) layout_.time_scale_s = likelyScale_s();
    clock_known_ = true;
    for (GazeSample& sample : held_) {
      sample.time_s *= layout_.time_scale_s;
      take_(sample);
    }
    held_.clear();
  }

  double likelyScale_s() const {
    constexpr double kSlowest_Hz = 5.0, kFastest_Hz = 20'000.0;
    std::vector<double> intervals;
    for (std::size_t i = 1; i < held_.size(); ++i) {
      intervals.push_back(held_[i].time_s - held_[i - 1].time_s);
    }
    if (intervals.empty()) return 1.0;
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
      const double rate_Hz = 1.0 / (*middle * scale_s);
      if (rate_Hz >= kSlowest_Hz && rate_Hz <= kFastest_Hz) return scale_s;
    }
    return 1.0;
  }

  LineReader& lines_;
  const TakeSample& take_;
  Preamble preamble_;
  TableLayout layout_{};
  GazeUnits units_ = GazeUnits::px;
  Fields fields_{};
  Cyclopean cyclopean_{};
  bool clock_known_ = false, resolution_known_ = false;
  std::optional<double> last_time_{};
  std::vector<GazeSample> held_{};
  std::size_t taken_ = 0;
  bool broken_ = false;  // the line before had too few fields
  std::array<bool, 2> eyes_seen_{};
};

}  // namespace

TraceHeader readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                               const Screen& fallback_screen, const TakeSample& take,
                               const std::string& header) {
  return TableReader(lines, columns, fallback_screen, take, header).read();
}

}  // namespace foci
