#include "gaze/sources/table_preamble.h"

#include <string>
#include <vector>

#include "gaze/sources/table_layout.h"

namespace foci {

double numberIn(const LineReader& lines, std::string_view key, std::string_view text, double low,
                double high, const char* range) {
  const auto value = parseNumber(text);
  if (value && *value >= low && *value <= high) return *value;
  throw lines.error(std::string(key) + " = " + shown(text) + ": expected " + range);
}

namespace {

void readKeys(const LineReader& lines, std::string_view line, TablePreamble& result) {
  std::vector<std::string_view> words;
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

/// BeGaze writes lengths in millimetres.
void readSmi(const LineReader& lines, std::string_view line, TablePreamble& result) {
  std::vector<std::string_view> fields;
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

}  // namespace

void readPreambleLine(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  if (line.starts_with("##")) {
    readSmi(lines, line, preamble);
  } else {
    readKeys(lines, line, preamble);
  }
}

}  // namespace foci
