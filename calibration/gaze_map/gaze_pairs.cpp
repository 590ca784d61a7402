#include "calibration/gaze_map/gaze_pairs.h"

#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 6> kColumns{"x",        "y",      "x_target",
                                                   "y_target", "time_s", "weight"};
constexpr std::size_t kNeeded = 4;
constexpr std::size_t kMaxRows = 2'000'000;
constexpr double kMaxGaze = 1e6;

struct Range {
  double low, high;
};

Range targetRange(MapUnits units) {
  switch (units) {
    case MapUnits::deg:
      return {-80.0, 80.0};
    case MapUnits::norm:
      return {-1.0, 2.0};
    case MapUnits::direction:
      return {-6.0, 6.0};
  }
  return {0.0, 0.0};
}

}  // namespace

std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units) {
  LineReader lines(file);
  std::string_view line;

  // Find the named columns.
  std::vector<std::string_view> fields;
  TablePreamble preamble;
  if (!nextHeaderLine(lines, line, preamble)) {
    throw InputError(lines.fileName(), "empty: expected a header row x y x_target y_target");
  }
  const char delimiter = delimiterOf(line, preamble);
  splitRow(line, delimiter, fields);
  std::array<std::optional<std::size_t>, kColumns.size()> column;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (fields[i] != kColumns[c]) continue;
      if (column[c]) throw lines.error("column " + std::string(kColumns[c]) + " twice");
      column[c] = i;
    }
  }
  for (std::size_t c = 0; c < kNeeded; ++c) {
    if (!column[c]) {
      throw lines.error("no column " + std::string(kColumns[c]) +
                        ": expected a header row x y x_target y_target");
    }
  }
  const std::size_t width = fields.size();

  std::vector<GazePair> pairs;
  CommaNumbers commas(delimiter);
  const auto [low, high] = targetRange(units);
  while (lines.next(line)) {
    if (trimmed(line).empty() || line.front() == '#') continue;
    splitRow(line, delimiter, fields);
    while (fields.size() > width && fields.back().empty()) fields.pop_back();
    if (fields.size() != width) {
      throw lines.error(std::to_string(fields.size()) + " fields: expected " +
                        std::to_string(width));
    }
    if (pairs.size() == kMaxRows) {
      throw lines.error("more than 2 million rows: not a calibration");
    }
    const auto valueOf = [&](std::size_t c, double low_value,
                             double high_value) -> std::optional<double> {
      if (!column[c] || isAbsent(fields[*column[c]])) return std::nullopt;
      const std::string_view field = fields[*column[c]];
      const std::optional<double> value = commas.parse(field);
      if (!value || *value < low_value || *value > high_value) {
        char range[80];
        std::snprintf(range, sizeof range, ": expected a number from %g to %g", low_value,
                      high_value);
        throw lines.error(std::string(kColumns[c]) + " = " + shown(field) + range);
      }
      if (c < 2) commas.note(lines, *column[c], field, c, *value);
      return value;
    };
    const auto x = valueOf(0, -kMaxGaze, kMaxGaze);
    const auto y = valueOf(1, -kMaxGaze, kMaxGaze);
    const auto x_target = valueOf(2, low, high);
    const auto y_target = valueOf(3, low, high);
    if (!x_target || !y_target) throw lines.error("a row without a target");
    GazePair pair{.target = {*x_target, *y_target}};
    if (x && y) pair.gaze = glm::dvec2(*x, *y);
    pair.time_s = valueOf(4, -1e12, 1e12);
    pair.weight = valueOf(5, 0.0, 1e9).value_or(1.0);
    pairs.push_back(pair);
  }
  commas.example();  // refuses separators of thousands
  if (pairs.empty()) throw InputError(lines.fileName(), "no rows below the header");
  return pairs;
}

}  // namespace foci
