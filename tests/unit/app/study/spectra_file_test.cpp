// Tables of a display's spectra: what is read, and what is refused.
#include "app/study/eye_tables.h"

#include <gtest/gtest.h>

#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

std::string rows(int from_nm, int to_nm, const std::string& separator = ",") {
  std::string text;
  for (int nm = from_nm; nm <= to_nm; nm += 20) {
    text += std::to_string(nm) + separator + "1" + separator + "0.5" + separator + "2\n";
  }
  return text;
}

std::vector<SpectrumSample> read(const std::string& text) {
  const TemporaryFolder folder;
  return readSpectra(folder.write("spectra.csv", text));
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("spectra.csv"));
  }
  return "read";
}

TEST(SpectraFile, ReadsTheUsualSeparatorsAndAHeading) {
  for (const std::string separator : {",", ";", "\t", "  "}) {
    for (const std::string heading : {"", "# made up\nwavelength_nm,red,green,blue\n"}) {
      const std::vector<SpectrumSample> spectra = read(heading + rows(400, 700, separator));
      ASSERT_EQ(spectra.size(), 16u);
      EXPECT_EQ(spectra.front().wavelength_nm, 400.0);
      EXPECT_EQ(spectra.back().red_green_blue, glm::dvec3(1.0, 0.5, 2.0));
    }
  }
}

TEST(SpectraFile, RefusesWhatCanBeMisread) {
  EXPECT_EQ(refusal("500,1,2\n"),
            "spectra.csv:1: 3 numbers: expected wavelength_nm, red, green, blue");
  EXPECT_EQ(refusal("0.5,1,1,1\n"), "spectra.csv:1: wavelength \"0.5\": expected nm, 360 to 830");
  EXPECT_EQ(refusal("500,1,1,1\n500,1,1,1\n"),
            "spectra.csv:2: wavelength \"500\": expected above the one before");
  EXPECT_EQ(refusal("500,1,-1,1\n"), "spectra.csv:1: \"-1\": expected a number, 0 or more");
  EXPECT_EQ(refusal(rows(520, 700)),
            "spectra.csv: expected at least 8 wavelengths, from 500 nm or less to 600 nm or more");
  EXPECT_EQ(refusal("400,0,1,1\n450,0,1,1\n500,0,1,1\n520,0,1,1\n540,0,1,1\n560,0,1,1\n600,0,1,"
                    "1\n650,0,1,1\n"),
            "spectra.csv: a primary without light: expected red, green and blue above 0");
}

}  // namespace FOCI_FILE
}  // namespace foci
