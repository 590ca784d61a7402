#include "gaze/sources/table_preamble.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/number.h"
#include "base/text.h"

namespace foci {

std::optional<GazeUnits> unitsNamed(std::string_view name) {
  if (name == "px" || name == "pixels") return GazeUnits::px;
  if (name == "deg" || name == "dva" || name == "degrees") return GazeUnits::deg;
  if (name == "normalised" || name == "normalized" || name == "norm") return GazeUnits::normalised;
  if (name == "relative") return GazeUnits::relative;
  return std::nullopt;
}

double numberIn(const Place& place, std::string_view key, std::string_view text, double low,
                double high, const char* range) {
  const auto value = parseNumber(text);
  if (value && *value >= low && *value <= high) return *value;
  throw place.error(std::string(key) + " = " + shown(text) + ": expected " + range);
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
        throw lines.error("units = " + shown(text) + ": expected px, deg, normalised or relative");
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

/// A line of SMI's BeGaze or IDF Converter. Its lengths are in millimetres; 0 means unknown.
void readSmi(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  const std::size_t colon = line.find(':');
  const std::string_view key = trimmed(line.substr(2, colon == line.npos ? colon : colon - 2));
  const auto names = [&](std::string_view part) { return key.find(part) != key.npos; };
  preamble.smi |= names("BeGaze") || names("iView") || names("Calibration Area") ||
                  line.find("IDF Converter") != line.npos;
  if (colon == line.npos) return;
  std::vector<std::string_view> values;
  splitWords(line.substr(colon + 1), values);
  const auto known = [&](std::size_t count) {
    return values.size() >= count &&
           std::none_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count),
                        [](std::string_view text) { return parseNumber(text) == 0.0; });
  };
  const auto value = [&](std::size_t i, double low, double high, const char* range) {
    return numberIn(lines, key, values[i], low, high, range);
  };
  if (names("Calibration Area") && known(2)) {
    preamble.screen.size_px = {static_cast<int>(value(0, 16, 16384, "16 to 16384 px")),
                               static_cast<int>(value(1, 16, 16384, "16 to 16384 px"))};
  } else if (names("Stimulus Dimension") && known(2)) {
    preamble.screen.size_m = 1e-3 * glm::dvec2(value(0, 10, 20000, "10 to 20000 mm"),
                                               value(1, 10, 20000, "10 to 20000 mm"));
  } else if (names("Head Distance") && known(1)) {
    preamble.screen.distance_m = 1e-3 * value(0, 10, 20000, "10 to 20000 mm");
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

bool readSeparatorLine(std::string_view line, TablePreamble& preamble) {
  constexpr std::string_view kKey = "sep=";
  if (!line.starts_with(kKey) || line.size() != kKey.size() + 1) return false;
  preamble.separator = line.back();
  return true;
}

bool nextHeaderLine(LineReader& lines, std::string_view& line, TablePreamble& preamble) {
  while (lines.next(line)) {
    if (readSeparatorLine(line, preamble)) continue;
    if (!trimmed(line).empty() && line.front() != '#') return true;
  }
  return false;
}

char delimiterOf(std::string_view header, const TablePreamble& before) {
  if (before.separator) return *before.separator;
  const auto has = [&](char c) { return header.find(c) != std::string_view::npos; };
  return has('\t') ? '\t' : has(';') ? ';' : has(',') ? ',' : ' ';
}

bool startsTobiiStudio(std::string_view line) { return line.starts_with("System Properties:"); }

std::optional<glm::ivec2> resolutionIn(const Place& place, std::string_view text) {
  const std::size_t times = text.find_first_of("xX");
  if (times == text.npos) return std::nullopt;
  const auto side = [&](std::string_view number) {
    return static_cast<int>(
        numberIn(place, "resolution", trimmed(number), 16, 16384, "16 to 16384 px"));
  };
  return glm::ivec2(side(text.substr(0, times)), side(text.substr(times + 1)));
}

bool readTobiiStudioLine(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  if (line.starts_with("Timestamp\t")) return false;
  constexpr std::string_view kResolution = "Recording resolution:";
  if (line.starts_with(kResolution)) {
    const auto size_px = resolutionIn(lines, trimmed(line.substr(kResolution.size())));
    if (size_px) preamble.screen.size_px = *size_px;
  }
  return true;
}

}  // namespace foci
