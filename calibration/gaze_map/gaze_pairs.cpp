#include "calibration/gaze_map/gaze_pairs.h"

#include <array>
#include <cmath>
#include <fstream>

#include "base/input_error.h"
#include "base/number.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 6> kColumns{"x",        "y",      "x_target",
                                                   "y_target", "time_s", "weight"};
constexpr std::size_t kNeeded = 4;
constexpr std::size_t kMaxColumns = 256;
constexpr std::size_t kMaxRows = 2'000'000;
constexpr std::size_t kMaxLine = 65536;
constexpr double kMaxGaze = 1e6;

/// Splits a line into fields; blanks separate only where the line has neither tab nor comma.
void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  const char separator = line.find('\t') != line.npos  ? '\t'
                         : line.find(',') != line.npos ? ','
                                                       : ' ';
  while (fields.size() < kMaxColumns) {
    if (separator == ' ') line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    const std::size_t end = line.find(separator);
    std::string_view field = line.substr(0, end);
    while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
    while (!field.empty() && field.back() == ' ') field.remove_suffix(1);
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    if (end == line.npos) return;
    line.remove_prefix(end + 1);
  }
}

bool isMissing(std::string_view field) {
  return field.empty() || field == "." || field == "n/a" || field == "N/A" || field == "NA" ||
         field == "nan" || field == "NaN" || field == "NAN";
}

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
  const std::string name = file.string();
  requireRegularFile(file);
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) throw InputError(name, "cannot be read");

  std::string line;
  std::size_t line_number = 0;
  const auto nextLine = [&] {
    line.clear();
    if (!std::getline(in, line)) return false;
    ++line_number;
    if (line.size() > kMaxLine) throw InputError(name, "line longer than 65536 characters");
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  };
  const auto refuse = [&](const std::string& what) -> InputError {
    return {name + ":" + std::to_string(line_number), what};
  };

  // Find the named columns.
  std::vector<std::string_view> fields;
  if (!nextLine()) throw InputError(name, "empty: expected a header row x y x_target y_target");
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  split(line, fields);
  std::array<std::optional<std::size_t>, kColumns.size()> column;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (fields[i] != kColumns[c]) continue;
      if (column[c]) throw refuse("column " + std::string(kColumns[c]) + " twice");
      column[c] = i;
    }
  }
  for (std::size_t c = 0; c < kNeeded; ++c) {
    if (!column[c]) {
      throw refuse("no column " + std::string(kColumns[c]) +
                   ": expected a header row x y x_target y_target");
    }
  }
  const std::size_t width = fields.size();

  std::vector<GazePair> pairs;
  const auto [low, high] = targetRange(units);
  while (nextLine()) {
    if (line.find_first_not_of(" \t") == line.npos || line.front() == '#') continue;
    split(line, fields);
    if (fields.size() != width) {
      throw refuse(std::to_string(fields.size()) + " fields: expected " + std::to_string(width));
    }
    if (pairs.size() == kMaxRows) throw refuse("more than 2 million rows: not a calibration");
    const auto valueOf = [&](std::size_t c, double low_value,
                             double high_value) -> std::optional<double> {
      if (!column[c] || isMissing(fields[*column[c]])) return std::nullopt;
      const std::string_view field = fields[*column[c]];
      const std::optional<double> value = parseNumber(field);
      if (!value || *value < low_value || *value > high_value) {
        char range[80];
        std::snprintf(range, sizeof range, ": expected a number from %g to %g", low_value,
                      high_value);
        throw refuse(std::string(kColumns[c]) + " = " + std::string(field.substr(0, 40)) + range);
      }
      return value;
    };
    const auto x = valueOf(0, -kMaxGaze, kMaxGaze);
    const auto y = valueOf(1, -kMaxGaze, kMaxGaze);
    const auto x_target = valueOf(2, low, high);
    const auto y_target = valueOf(3, low, high);
    if (!x_target || !y_target) throw refuse("a row without a target");
    GazePair pair{.target = {*x_target, *y_target}};
    if (x && y) pair.gaze = glm::dvec2(*x, *y);
    pair.time_s = valueOf(4, -1e12, 1e12);
    pair.weight = valueOf(5, 0.0, 1e9).value_or(1.0);
    pairs.push_back(pair);
  }
  if (pairs.empty()) throw InputError(name, "no rows below the header");
  return pairs;
}

}  // namespace foci
