#include "gaze/sources/table_preamble.h"

#include <string>
#include <vector>

#include "base/number.h"
#include "base/text.h"

namespace foci {

std::optional<GazeUnits> unitsNamed(std::string_view name) {
  if (name == "px" || name == "pixels") return GazeUnits::px;
  if (name == "deg" || name == "dva" || name == "degrees") return GazeUnits::deg;
  if (name == "normalised" || name == "normalized" || name == "norm") return GazeUnits::normalised;
  return std::nullopt;
}

double numberIn(const LineReader& lines, std::string_view key, std::string_view text, double low,
                double high, const char* range) {
  const auto value = parseNumber(text);
  if (value && *value >= low && *value <= high) return *value;
  throw lines.error(std::string(key) + " = " + shown(text) + ": expected " + range);
}

namespace {

void readKeys(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  std::vector<std::string_view> words;
  splitWords(line.substr(1), words);
  for (const std::string_view word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) continue;
    const auto key = word.substr(0, equals), text = word.substr(equals + 1);
    if (key == "units") {
      preamble.units = unitsNamed(text);
      if (!preamble.units) {
        throw lines.error("units = " + shown(text) + ": expected px, deg or normalised");
      }
      continue;
    }
    const auto pixels = [&] {
      return static_cast<int>(numberIn(lines, key, text, 16, 16384, "16 to 16384 px"));
    };
    const auto metres = [&] { return numberIn(lines, key, text, 0.01, 20.0, "0.01 to 20 m"); };
    if (key == "sampling_Hz") {
      preamble.rate_Hz = numberIn(lines, key, text, 5.0, 20000.0, "5 to 20000");
    }
    if (key == "screen_width_px") preamble.screen.size_px.x = pixels();
    if (key == "screen_height_px") preamble.screen.size_px.y = pixels();
    if (key == "screen_width_m") preamble.screen.size_m.x = metres();
    if (key == "screen_height_m") preamble.screen.size_m.y = metres();
    if (key == "viewing_distance_m") preamble.screen.distance_m = metres();
  }
}

/// A line of SMI BeGaze. Its lengths are in millimetres.
void readSmi(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  std::vector<std::string_view> fields;
  splitFields(line, '\t', fields);
  const auto starts = [&](std::string_view key) {
    return fields[0].find(key) != std::string_view::npos;
  };
  preamble.smi |= starts("BeGaze") || starts("iView") || starts("Calibration Area");
  const auto value = [&](std::size_t i, double low, double high, const char* range) {
    return numberIn(lines, trimmed(fields[0].substr(2)), fields[i], low, high, range);
  };
  if (starts("Calibration Area") && fields.size() >= 3) {
    preamble.screen.size_px = {static_cast<int>(value(1, 16, 16384, "16 to 16384 px")),
                               static_cast<int>(value(2, 16, 16384, "16 to 16384 px"))};
  } else if (starts("Stimulus Dimension") && fields.size() >= 3) {
    preamble.screen.size_m = 1e-3 * glm::dvec2(value(1, 10, 20000, "10 to 20000 mm"),
                                               value(2, 10, 20000, "10 to 20000 mm"));
  } else if (starts("Head Distance") && fields.size() >= 2) {
    preamble.screen.distance_m = 1e-3 * value(1, 10, 20000, "10 to 20000 mm");
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
