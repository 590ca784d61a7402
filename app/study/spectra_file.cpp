#include "app/study/eye_tables.h"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kLeast_nm = 360.0, kMost_nm = 830.0;
constexpr std::size_t kMostSamples = 10000;
constexpr std::uintmax_t kMostBytes = 4 << 20;  // far above such a table

using SpectraColumns = std::array<std::size_t, 4>;  // of wavelength, red, green and blue
constexpr std::array kColours{"red", "green", "blue"};

/// As the heading names them: "Red (W)", "g". The wavelength is the first one.
std::optional<SpectraColumns> columnsIn(const std::vector<std::string>& heading) {
  SpectraColumns columns{};
  for (std::size_t at = 0; at < heading.size(); ++at) {
    const std::string cell = lowered(heading[at]);
    const std::string name = cell.substr(0, cell.find_first_of(" _([,/"));
    for (std::size_t i = 0; i < 3; ++i) {
      if (name != kColours[i] && name != std::string(1, kColours[i][0])) continue;
      if (at == 0 || columns[i + 1] != 0) return std::nullopt;
      columns[i + 1] = at;
    }
  }
  return std::ranges::count(columns, 0u) == 1 ? std::optional(columns) : std::nullopt;
}

bool isRendered(const SpectrumSample& one) {
  return one.wavelength_nm > 400.0 && one.wavelength_nm < 700.0;
}

/// Whether the mean wavelengths are in the order of red, green and blue.
bool areInOrder(const std::vector<SpectrumSample>& spectra) {
  glm::dvec3 power(0.0), mean_nm(0.0);
  for (const SpectrumSample& one : spectra) {
    if (!isRendered(one)) continue;
    power += one.red_green_blue;
    mean_nm += one.wavelength_nm * one.red_green_blue;
  }
  mean_nm /= power;
  return mean_nm.r > mean_nm.g && mean_nm.g > mean_nm.b;
}

/// Splits lines into cells, and reads numbers. Beside semicolons and tabs, commas are decimal.
class SpectraCells {
 public:
  explicit SpectraCells(const std::string& text) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
      if (trimmed(line).starts_with('#')) continue;
      decimal_comma_ |= line.find_first_of(";\t") != line.npos;
      commas_ |= line.find(',') != line.npos;
    }
  }

  std::vector<std::string> of(std::string_view line) const {
    std::vector<std::string> cells;
    for (const std::string_view cell : wordsOf(trimmed(line), decimal_comma_ ? ";\t"
                                                              : commas_      ? ","
                                                                             : " ")) {
      cells.emplace_back(trimmed(cell));
    }
    return cells;
  }

  std::optional<double> number(std::string cell) const {
    if (decimal_comma_) std::ranges::replace(cell, ',', '.');
    return parseNumber(cell);
  }

 private:
  bool decimal_comma_ = false, commas_ = false;
};

}  // namespace

std::vector<SpectrumSample> readSpectra(const std::filesystem::path& file) {
  const std::string text(withoutByteOrderMark(bytesOfFile(file, kMostBytes)));
  const SpectraCells split(text);
  std::istringstream in(text);
  std::vector<SpectrumSample> spectra;
  std::vector<std::string> heading;
  SpectraColumns columns{0, 1, 2, 3};
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto fail = [&](const std::string& what) {
      throw InputError(file.string() + ":" + std::to_string(number), what);
    };
    const std::vector<std::string> cells = split.of(line);
    if (cells.empty() || cells[0].starts_with('#')) continue;
    if (spectra.empty() && !split.number(cells[0])) {
      heading = cells;
      continue;
    }
    if (spectra.empty() && !heading.empty()) {
      const auto named = columnsIn(heading);
      if (!named) fail("the heading above: expected wavelength_nm first, and red, green and blue");
      columns = *named;
    }
    if (cells.size() != (heading.empty() ? 4 : heading.size())) {
      fail(std::to_string(cells.size()) + " numbers: expected wavelength_nm, red, green, blue" +
           (heading.size() > 4 ? ", and the others of the heading" : ""));
    }
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string& cell = cells[columns[i]];
      const auto value = split.number(cell);
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
  if (heading.empty() && !areInOrder(spectra)) {
    throw InputError(file.string(),
                     "no heading, and the columns are not red, green, blue by their mean "
                     "wavelengths: expected a heading such as wavelength_nm,red,green,blue");
  }
  return spectra;
}

}  // namespace foci
