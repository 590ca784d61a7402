#include "app/study/field_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/line_reader.h"

namespace foci {
namespace {

constexpr double kMostField_angle_deg = 90.0, kMostField_um = 50.0;
constexpr std::size_t kMostRows = 200000;

/// The columns by what they hold: the two angles, z3 to z8, and the subject.
constexpr std::array<std::string_view, 9> kColumns{"horizontal_deg", "vertical_deg", "z3_um",
                                                   "z4_um",          "z5_um",        "z6_um",
                                                   "z7_um",          "z8_um",        "subject"};
constexpr std::size_t kSubject = 8;

}  // namespace

FieldAberrations readFieldAberrations(const std::filesystem::path& file) {
  LineReader lines(file);
  std::array<std::optional<std::size_t>, kColumns.size()> columns;
  char separator = '\t';
  std::vector<FieldSample> samples;
  std::vector<std::string_view> cells;
  bool heading = true;
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    if (heading) {
      heading = false;
      for (const char each : {',', ';'}) {
        if (line.find(each) != std::string_view::npos) separator = each;
      }
      splitFields(line, separator, cells);
      for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const auto at = std::ranges::find_if(
            cells, [&](std::string_view cell) { return trimmed(cell) == kColumns[i]; });
        if (at != cells.end()) columns[i] = static_cast<std::size_t>(at - cells.begin());
        if (!columns[i] && i != kSubject) {
          throw lines.error("no column " + std::string(kColumns[i]) +
                            ": expected horizontal_deg, vertical_deg and z3_um to z8_um");
        }
      }
      continue;
    }
    splitFields(line, separator, cells);
    const auto numberIn = [&](std::size_t i, double most) {
      const std::string_view cell = *columns[i] < cells.size() ? trimmed(cells[*columns[i]]) : "";
      const auto value = parseNumber(cell);
      if (!value || !(std::abs(*value) <= most)) {
        throw lines.error(std::string(kColumns[i]) + " " + shown(cell) +
                          ": expected a number from " + decimal(-most, 0) + " to " +
                          decimal(most, 0));
      }
      return *value;
    };
    FieldSample sample{
        .field_deg = {numberIn(0, kMostField_angle_deg), numberIn(1, kMostField_angle_deg)}};
    for (std::size_t j = 0; j < sample.z_um.size(); ++j) {
      sample.z_um[j] = numberIn(2 + j, kMostField_um);
    }
    if (columns[kSubject]) sample.eye = static_cast<int>(numberIn(kSubject, 1e6));
    if (samples.size() == kMostRows) throw lines.error("expected at most 200000 rows");
    samples.push_back(sample);
  }
  FieldAberrations field;
  if (!fitField(samples, field)) {
    throw InputError(file.string(),
                     std::to_string(samples.size()) +
                         " directions do not tell the field: expected rows for the fovea (within 5 "
                         "degrees) and at least 5 angles along and 5 across the horizontal");
  }
  return field;
}

}  // namespace foci
