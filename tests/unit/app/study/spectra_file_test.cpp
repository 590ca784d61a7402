// Tables of a display's spectra: what is read, and what is refused.
#include "app/study/eye_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

/// Red has 1 at long wavelengths, green 0.5 everywhere, and blue 2 at short ones; else 0.25.
std::string rows(int from_nm, int to_nm, const std::string& separator = ",",
                 const std::string& order = "rgb") {
  std::string text;
  for (int nm = from_nm; nm <= to_nm; nm += 20) {
    text += std::to_string(nm);
    for (const char colour : order) {
      const bool lit = colour == 'r' ? nm > 600 : colour == 'b' && nm < 500;
      const char* const power = colour == 'g' ? "0.5" : !lit ? "0.25" : colour == 'r' ? "1" : "2";
      text += separator + power;
    }
    text += "\n";
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
    const std::string names =
        "wavelength_nm" + separator + "red" + separator + "green" + separator + "blue\n";
    for (const std::string& heading : {std::string(), "# made up\n" + names}) {
      const std::vector<SpectrumSample> spectra = read(heading + rows(400, 700, separator));
      ASSERT_EQ(spectra.size(), 16u);
      EXPECT_EQ(spectra.front().wavelength_nm, 400.0);
      EXPECT_EQ(spectra.back().red_green_blue, glm::dvec3(1.0, 0.5, 0.25));
    }
  }
}

TEST(SpectraFile, TheHeadingNamesTheColours) {
  const auto expectColours = [](const std::string& text) {
    const std::vector<SpectrumSample> spectra = read(text);
    EXPECT_EQ(spectra.front().red_green_blue, glm::dvec3(0.25, 0.5, 2.0)) << text;
    EXPECT_EQ(spectra.back().red_green_blue, glm::dvec3(1.0, 0.5, 0.25)) << text;
  };
  expectColours("nm,blue,green,red\n" + rows(400, 700, ",", "bgr"));
  expectColours("Lambda (nm);B (W);R (W);G (W)\n" + rows(400, 700, ";", "brg"));
  expectColours("nm,white,red,green,blue\n" + rows(400, 700, ",", "grgb"));
  expectColours("made by hand\nnm r_W g_W b_W\n" + rows(400, 700, " "));
  std::string decimal_comma = "nm;red;green;blue\n" + rows(400, 700, ";");
  std::ranges::replace(decimal_comma, '.', ',');
  expectColours(decimal_comma);
  const std::string commas = rows(400, 700), blanks = rows(400, 700, " ");
  expectColours("\"nm\",\"blue\",\"green\",\"red\"\n" + rows(400, 700, ",", "bgr"));
  expectColours("nm,power.blue,power.green,power.red\n" + rows(400, 700, ",", "bgr"));
  expectColours("nm,blue-primary,green-primary,red-primary\n" + rows(400, 700, ",", "bgr"));
  expectColours("wavelength (nm) blue green red\n" + rows(400, 700, " ", "bgr"));
  expectColours("nm,blueish,bg,Red,Green,Blue\n" + rows(400, 700, ",", "bgrgb"));
  expectColours("wavelength,blue,green,red\nnm,W,W,W\n" + rows(400, 700, ",", "bgr"));
  expectColours("nm,red,green,blue,notes\n" + commas);
  expectColours("nm,\tred,\tgreen,\tblue\n" + rows(400, 700, ",\t"));
  expectColours("nm;red;green;blue\n" + rows(400, 700, ";\t"));
  expectColours("nm, red, green, blue\n" + rows(400, 700, "\t"));
  expectColours("nm , red , green , blue\n" + rows(400, 700, " , "));
  expectColours("nm red green blue ;\n" + blanks);
  expectColours("Measured on 2 May, 2024\nnm red green blue\n" + blanks);
  expectColours("PR-655; 2024-01-02\nnm,red,green,blue\n" + commas);
  for (const char* heading : {"made by hand", "nm,x,y,z", "nm,red,red,green,blue", "red,nm,g,b"}) {
    expectColours(heading + ("\n" + commas));
  }
  EXPECT_EQ(
      refusal(rows(400, 700, ",", "bgr")),
      "spectra.csv: no heading of them, and the columns are not red, green, blue by their mean "
      "wavelengths: expected a heading such as wavelength_nm,red,green,blue");
}

TEST(SpectraFile, ADisplayMayBeGrey) { EXPECT_EQ(read(rows(400, 700, ",", "ggg")).size(), 16u); }

TEST(SpectraFile, RefusesWhatCanBeMisread) {
  EXPECT_EQ(refusal("500,1,2\n"),
            "spectra.csv:1: 3 numbers: expected wavelength_nm, red, green, blue");
  EXPECT_EQ(refusal("0.5,1,1,1\n"), "spectra.csv:1: wavelength \"0.5\": expected nm, 360 to 830");
  EXPECT_EQ(refusal("500,1,1,1\n500,1,1,1\n"),
            "spectra.csv:2: wavelength \"500\": expected above the one before");
  EXPECT_EQ(refusal("# made up\nno spectra\n"),
            "spectra.csv: \"no spectra\": expected rows of wavelength_nm, red, green, blue");
  EXPECT_EQ(refusal("nm,white,red,green,blue\n500,1,1,1\n"),
            "spectra.csv:2: 4 numbers: expected wavelength_nm, red, green, blue, and the others of "
            "the heading");
  EXPECT_EQ(refusal("500,1,-1,1\n"), "spectra.csv:1: \"-1\": expected a number, 0 or more");
  EXPECT_EQ(refusal(rows(520, 700)),
            "spectra.csv: expected at least 8 wavelengths, from 500 nm or less to 600 nm or more");
  EXPECT_EQ(refusal("400,0,1,1\n450,0,1,1\n500,0,1,1\n520,0,1,1\n540,0,1,1\n560,0,1,1\n600,0,1,"
                    "1\n650,0,1,1\n"),
            "spectra.csv: a primary without light: expected red, green and blue above 0");
}

}  // namespace FOCI_FILE
}  // namespace foci
