// Tables of aberrations over the visual field: what is read, and what is refused.
#include "app/study/eye_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/line_reader.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr const char* kHeading =
    "subject\thorizontal_deg\tvertical_deg\tz3_um\tz4_um\tz5_um\tz6_um\tz7_um\tz8_um\n";

/// Defocus of 0.1 um at each 10 degrees from the fovea, squared; all else 0.
std::string rows() {
  std::string text;
  for (int x = -40; x <= 40; x += 10) {
    for (int y = -24; y <= 24; y += 6) {
      text += "1\t" + std::to_string(x) + "\t" + std::to_string(y) + "\t0\t" +
              decimal((x * x + y * y) / 1000.0, 6) + "\t0\t0\t0\t0\n";
    }
  }
  return text;
}

FieldAberrations read(const std::string& text) {
  const TemporaryFolder folder;
  return readFieldAberrations(folder.write("field.tsv", text));
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("field.tsv"));
  }
  return "read";
}

TEST(FieldFile, ReadsColumnsByTheirNames) {
  const double power_D = read(kHeading + rows()).at({20.0, 10.0}, false).power_D.x;
  EXPECT_NEAR(power_D, std::sqrt(3.0) * 0.5, 1e-3);
  std::string commas = "# made up\n" + std::string(kHeading) + rows();
  std::ranges::replace(commas, '\t', ',');
  EXPECT_NEAR(read(commas).at({20.0, 10.0}, false).power_D.x, power_D, 1e-9);
}

TEST(FieldFile, RefusesWhatItCannotUse) {
  const std::string row = "1\t5\t0\t0\t0\t0\t0\t0\t";
  EXPECT_EQ(refusal("a,b\n1,2\n"),
            "field.tsv:1: no column horizontal_deg: expected horizontal_deg, vertical_deg and "
            "z3_um to z8_um");
  EXPECT_EQ(refusal(kHeading + row + "x\n"),
            "field.tsv:2: z8_um = \"x\": expected a number from -50 to 50");
  EXPECT_EQ(refusal(kHeading + row + "99\n"),
            "field.tsv:2: z8_um = \"99\": expected a number from -50 to 50");
  EXPECT_EQ(refusal(kHeading + row + "nan\n"),
            "field.tsv:2: z8_um = \"nan\": expected a number from -50 to 50");
  EXPECT_NE(refusal(kHeading + row + "0\n").find("1 directions do not tell the field"),
            std::string::npos);
  EXPECT_NE(refusal(kHeading).find("0 directions do not tell the field"), std::string::npos);
}

/// The measurements that `typicalField` is fitted to.
std::filesystem::path measurements() {
  const char* folder = std::getenv("FOCI_DATA");
  return std::filesystem::path(folder ? folder : FOCI_SOURCE_DIR "/../shared/data") /
         "eye/polans2015.tsv.gz";
}

TEST(TypicalField, IsTheFitOfTheMeasurements) {
  if (!exists(measurements())) GTEST_SKIP() << "no " << measurements() << ": set FOCI_DATA";
  const FieldAberrations fitted = readFieldAberrations(measurements());
  const FieldAberrations& typical = typicalField();
  const auto compare = [](const auto& a, const auto& b) {
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-4) << i;
  };
  compare(fitted.power_D, typical.power_D);
  compare(fitted.j0_D, typical.j0_D);
  compare(fitted.j45_D, typical.j45_D);
  compare(fitted.coma7_um, typical.coma7_um);
  compare(fitted.coma8_um, typical.coma8_um);
}

double medianOf(std::vector<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

TEST(TypicalField, IsWithinAQuarterDioptreOfTheMedianEye) {
  if (!exists(measurements())) GTEST_SKIP() << "no " << measurements() << ": set FOCI_DATA";
  // By direction, of each eye: mean sphere, and J0 and J45, all as measured. Power is positive.
  std::map<std::pair<double, double>, std::array<std::vector<double>, 3>> eyes;
  LineReader lines(measurements());
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  while (lines.next(line)) {
    std::vector<double> v;
    for (const std::string_view word : wordsOf(line, "\t")) v.push_back(*parseNumber(word));
    auto& at = eyes[{v[1], v[2]}];
    at[0].push_back(std::sqrt(3.0) * v[4]);
    at[1].push_back(0.5 * std::sqrt(6.0) * v[5]);
    at[2].push_back(0.5 * std::sqrt(6.0) * v[3]);
  }
  // Refraction is relative to the fovea, here the middle 25 directions, where no median is far off.
  double fovea_D = 0.0;
  for (int x = -2; x <= 2; ++x) fovea_D += medianOf(eyes[{x, 0.0}][0]) / 5.0;
  std::array<double, 3> squares{};
  double count = 0.0;
  for (const auto& [at, values] : eyes) {
    const bool on_disc = at.first >= 10.0 && at.first <= 18.0 && std::abs(at.second) <= 5.0;
    if (on_disc) continue;
    const glm::dvec3 power_D = typicalField().at({at.first, -at.second}, false).power_D;
    for (int i = 0; i < 3; ++i) {
      const double measured =
          medianOf(values[static_cast<std::size_t>(i)]) - (i == 0 ? fovea_D : 0);
      squares[static_cast<std::size_t>(i)] += std::pow(measured - power_D[i], 2.0);
    }
    ++count;
  }
  EXPECT_LT(std::sqrt(squares[0] / count), 0.25);                       // refraction
  EXPECT_LT(2.0 * std::sqrt((squares[1] + squares[2]) / count), 0.25);  // astigmatism
}

}  // namespace FOCI_FILE
}  // namespace foci
