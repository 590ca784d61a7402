#include "app/study/eye_tables.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kLeast_nm = 360.0, kMost_nm = 830.0;
constexpr std::size_t kMostSamples = 10000;
constexpr std::uintmax_t kMostBytes = 4 << 20;  // far above such a table

}  // namespace

std::vector<SpectrumSample> readSpectra(const std::filesystem::path& file) {
  std::istringstream in(bytesOfFile(file, kMostBytes));
  std::vector<SpectrumSample> spectra;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    const auto fail = [&](const std::string& what) {
      throw InputError(file.string() + ":" + std::to_string(number), what);
    };
    ++number;
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::vector<std::string_view> words = wordsOf(line, ",;\t \r");
    if (words.empty() || words[0].starts_with('#')) continue;
    if (spectra.empty() && !parseNumber(words[0])) continue;  // the heading
    if (words.size() != 4) {
      fail(std::to_string(words.size()) + " numbers: expected wavelength_nm, red, green, blue");
    }
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto value = parseNumber(words[i]);
      if (!value || (i > 0 && *value < 0.0)) {
        fail(shown(words[i]) + ": expected a number, 0 or more");
      }
      values[i] = *value;
    }
    if (!(values[0] >= kLeast_nm && values[0] <= kMost_nm)) {
      fail("wavelength " + shown(words[0]) + ": expected nm, 360 to 830");
    }
    if (!spectra.empty() && !(values[0] > spectra.back().wavelength_nm)) {
      fail("wavelength " + shown(words[0]) + ": expected above the one before");
    }
    if (spectra.size() == kMostSamples) fail("expected at most 10000 wavelengths");
    spectra.push_back({values[0], {values[1], values[2], values[3]}});
  }
  glm::dvec3 light(0.0);
  for (const SpectrumSample& one : spectra) {
    const bool rendered = one.wavelength_nm > 400.0 && one.wavelength_nm < 700.0;
    if (rendered) light += luminousEfficiency(one.wavelength_nm) * one.red_green_blue;
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
  return spectra;
}

}  // namespace foci
