#include "app/study/eye_tables.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr double kLeast_nm = 360.0, kMost_nm = 830.0;
constexpr std::size_t kMostSamples = 10000;
constexpr std::uintmax_t kMostBytes = 4 << 20;  // far above such a table

struct SpectraHeading {
  std::size_t cells = 4;
  std::array<std::size_t, 4> columns{};  ///< of wavelength, red, green and blue
};

/// The heading that a line is, if it names the wavelength first and each colour once: "Red (W)",
/// "g", "power.blue".
std::optional<SpectraHeading> headingIn(std::string_view line) {
  constexpr std::array<std::string_view, 3> colours{"red", "green", "blue"};
  for (const char separator : {'\t', ';', ',', ' '}) {
    std::vector<std::string> cells = cellsOf(line, separator);
    if (separator == ' ') {  // wavelength (nm) red green blue
      std::erase_if(cells, [](const auto& cell) { return cell.find_first_of("([") == 0; });
    }
    SpectraHeading heading{.cells = cells.size()};
    int named = 0;
    for (std::size_t at = 0; at < cells.size(); ++at) {
      std::string text = lowered(cells[at]);
      std::ranges::replace_if(
          text, [](char c) { return c < 'a' || c > 'z'; }, ' ');
      for (const std::string_view word : wordsOf(text)) {
        for (std::size_t i = 0; i < 3; ++i) {
          if (word != colours[i] && word != colours[i].substr(0, 1)) continue;
          if (heading.columns[i + 1] == at) continue;  // "Red (R)"
          heading.columns[i + 1] = at;
          ++named;
        }
      }
    }
    const std::set distinct(heading.columns.begin(), heading.columns.end());
    if (named == 3 && distinct.size() == 4) return heading;
  }
  return std::nullopt;
}

bool startsWithNumber(std::string_view line) {
  const std::vector<std::string_view> words = wordsOf(line, " \t,;\"");
  return !words.empty() && parseNumber(words[0]);
}

/// What separates the numbers of a line. Beside semicolons and tabs, commas are decimal.
char separatorIn(std::string_view line) {
  const auto holds = [&](std::string_view text) { return line.find(text) != line.npos; };
  if (holds(";")) return ';';
  if (holds("\t") && !holds(",\t")) return '\t';
  return holds(",") ? ',' : ' ';
}

bool isRendered(const SpectrumSample& one) {
  return one.wavelength_nm > 400.0 && one.wavelength_nm < 700.0;
}

/// Whether the mean wavelengths are in the order of red, green and blue, or equal.
bool areInOrder(const std::vector<SpectrumSample>& spectra) {
  glm::dvec3 power(0.0), mean_nm(0.0);
  for (const SpectrumSample& one : spectra) {
    if (!isRendered(one)) continue;
    power += one.red_green_blue;
    mean_nm += one.wavelength_nm * one.red_green_blue;
  }
  mean_nm /= power;
  constexpr double kEqual_nm = 1e-6;
  return mean_nm.r >= mean_nm.g - kEqual_nm && mean_nm.g >= mean_nm.b - kEqual_nm;
}

}  // namespace

std::vector<SpectrumSample> readSpectra(const std::filesystem::path& file) {
  const std::string text(withoutByteOrderMark(bytesOfFile(file, kMostBytes)));
  std::istringstream in(text);
  std::vector<SpectrumSample> spectra;
  std::optional<SpectraHeading> named;
  std::string first;
  char separator = ' ';
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto fail = [&](const std::string& what) {
      throw InputError(file.string() + ":" + std::to_string(number), what);
    };
    const std::string_view content = trimmed(line);
    if (content.empty() || content.starts_with('#')) continue;
    if (spectra.empty()) {
      if (first.empty()) first = content;
      if (!startsWithNumber(content)) {
        if (const auto heading = headingIn(content)) named = heading;
        continue;
      }
      separator = separatorIn(content);
    }
    std::vector<std::string> cells = cellsOf(content, separator);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    const SpectraHeading heading = named.value_or(SpectraHeading{.columns = {0, 1, 2, 3}});
    if (cells.size() <= std::ranges::max(heading.columns) || cells.size() > heading.cells) {
      fail(std::to_string(cells.size()) + " numbers: expected wavelength_nm, red, green, blue" +
           (heading.cells > 4 ? ", and the others of the heading" : ""));
    }
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) {
      std::string cell = cells[heading.columns[i]];
      if (separator != ',') std::ranges::replace(cell, ',', '.');
      const auto value = parseNumber(cell);
      if (!value || (i > 0 && *value < 0.0)) fail(shown(cell) + ": expected a number, 0 or more");
      values[i] = *value;
    }
    if (!(values[0] >= kLeast_nm && values[0] <= kMost_nm)) {
      fail("wavelength " + shown(cells[0]) + ": expected nm, 360 to 830");
    }
    if (!spectra.empty() && !(values[0] > spectra.back().wavelength_nm)) {
      fail("wavelength " + shown(cells[0]) + ": expected above the one before");
    }
    if (spectra.size() == kMostSamples) fail("expected at most 10000 wavelengths");
    spectra.push_back({values[0], {values[1], values[2], values[3]}});
  }
  if (spectra.empty()) {
    throw InputError(file.string(),
                     shown(first) + ": expected rows of wavelength_nm, red, green, blue");
  }
  glm::dvec3 light(0.0);
  for (const SpectrumSample& one : spectra) {
    if (isRendered(one)) light += luminousEfficiency(one.wavelength_nm) * one.red_green_blue;
  }
  if (spectra.size() < 8 || spectra.front().wavelength_nm > 500.0 ||
      spectra.back().wavelength_nm < 600.0) {
    throw InputError(file.string(),
                     "expected at least 8 wavelengths, from 500 nm or less to 600 nm or more");
  }
  if (!(std::min({light.r, light.g, light.b}) > 0.0)) {
    throw InputError(file.string(),
                     "a primary without light: expected red, green and blue above 0");
  }
  if (!named && !areInOrder(spectra)) {
    throw InputError(file.string(),
                     "no heading of them, and the columns are not red, green, blue by their mean "
                     "wavelengths: expected a heading such as wavelength_nm,red,green,blue");
  }
  return spectra;
}

FieldAberrations readFieldAberrations(const std::filesystem::path& file) {
  constexpr double kMostField_angle_deg = 90.0, kMostField_um = 50.0;
  constexpr std::size_t kMostRows = 200000;
  NamedTable table(file, "horizontal_deg, vertical_deg and z3_um to z8_um");
  std::vector<std::size_t> columns;
  for (const char* name :
       {"horizontal_deg", "vertical_deg", "z3_um", "z4_um", "z5_um", "z6_um", "z7_um", "z8_um"}) {
    columns.push_back(table.column(name));
  }
  const std::optional<std::size_t> subject = table.find("subject");
  std::vector<FieldSample> samples;
  while (table.next()) {
    const auto angle_deg = [&](std::size_t i) {
      return table.needed(columns[i], -kMostField_angle_deg, kMostField_angle_deg);
    };
    FieldSample sample{.field_deg = {angle_deg(0), angle_deg(1)}};
    for (std::size_t j = 0; j < sample.z_um.size(); ++j) {
      sample.z_um[j] = table.needed(columns[2 + j], -kMostField_um, kMostField_um);
    }
    if (subject) sample.eye = static_cast<int>(table.needed(*subject, -1e6, 1e6));
    if (samples.size() == kMostRows) throw table.error("expected at most 200000 rows");
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
