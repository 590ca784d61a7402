// Tables of aberrometers: the same eye in every layout, and what is refused.
#include "app/study/eye_tables.h"

#include <gtest/gtest.h>

#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

MeasuredEyes read(const std::string& text, std::optional<double> pupil_mm = {}) {
  const TemporaryFolder folder;
  return readWavefronts(folder.write("eye.csv", text), pupil_mm);
}

std::string refusal(const std::string& text, std::optional<double> pupil_mm = {}) {
  try {
    read(text, pupil_mm);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("eye.csv"));
  }
  return "read";
}

/// Terms 4 and 8: 0.5 and -0.25 um, for 6 mm.
void expectTheEye(const std::optional<Wavefront>& eye) {
  ASSERT_TRUE(eye);
  EXPECT_DOUBLE_EQ(eye->pupil_m, 0.006);
  ASSERT_EQ(eye->zernike_um.size(), 9u);
  for (std::size_t j = 0; j < 9; ++j) {
    EXPECT_DOUBLE_EQ(eye->zernike_um[j], j == 4 ? 0.5 : j == 8 ? -0.25 : 0.0) << j;
  }
}

class Layouts : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(
    Tables, Layouts,
    testing::Values(
        "pupil_mm,6\nn,m,um\n2,0,0.5\n3,1,-0.25\n", "# pupil_mm = 6\nj;um\n4;0,5\n8;-0,25\n",
        "Pupil diameter: 6.0 mm\nindex\tvalue\n4\t0.5\n8\t-0.25\n",
        "pupil 6 mm\nZ4 0.5\nZ8 -0.25\n", "pupil,6,mm\nterm,nm\nZ(2,0),500\nZ(3,1),-250\n",
        "pupil_mm,6\nmode,OD,OS\nZ2+0,0.5,0.5\nZ3+1,-0.25,-0.25\n",
        "pupil_mm,6\n2,0,0.5\n3,1,-0.25\n", "eye,pupil_mm,Z4,Z8\nOD,6,0.5,-0.25\nOS,6,0.5,-0.25\n",
        "eye,pupil_mm,\"Z(2,0)\",\"Z(3,1)\",Z(3,-1)\nright,6,0.5,-0.25,0\nleft,6,0.5,-0.25,0\n",
        "pupil_mm,Z20,Z3-1,Z3+1\n6,0.5,0,-0.25\n",
        "j,coefficient_um,pupil_mm\n4,0.5,6\n8,-0.25,6\n",
        "Pupil radius (mm),3\nj,um\n4,0.5\n8,-0.25\n", "pupil_radius_mm,Z4,Z8\n3,0.5,-0.25\n",
        "eye,n,m,um,pupil_mm\nOD,2,0,0.5,6\nOD,3,1,-0.25,6\nOS,2,0,0.5,6\nOS,3,1,-0.25,6\n",
        "pupil_mm;6,0\nn;m;um\n2;0;0,5\n3;1;-0,25\n", "pupil_mm\t6,0\nj\tum\n4\t0,5\n8\t-0,25\n",
        "pupil_mm;6\nZ5;0,0\nZ4;0,5\nZ8;-0,25\n", "pupil_mm,6\nterm,um\nZ2_0,0.5\nZ3_1,-0.25\n",
        "pupil_mm,6\nn,m,value,unit\n2,0,500,nm\n3,1,-0.25,um\n",
        "eye,pupil_mm,unit,Z4,Z8\nOD,6,nm,500,-250\nOS,6,um,0.5,-0.25\n",
        "# Units: nm\npupil_mm,6\nj,value\n4,500\n8,-250\n",
        "# Wavefront coefficients (um) at lambda = 555 nm\npupil_mm,6\nj,value\n4,0.5\n8,-0.25\n",
        "# Zernike coefficients at 840 nm, pupil diameter in mm\npupil_mm,6\nj,c\n4,0.5\n8,-0.25\n",
        "pupil_mm,6\nunit,nm\nj,value\n4,500\n8,-250\n",
        "pupil_mm,6\nwavelength_nm,555\nj,um\n4,0.5\n8,-0.25\n",
        "pupil_mm,6\nOSA index,Noll index,um\n4,4,0.5\n8,8,-0.25\n",
        "# Units: nm\npupil_mm,6\nj,um\n4,0.5\n8,-0.25\n",
        "# values in waves\npupil_mm,6\nn,m,value,unit\n2,0,500,nm\n3,1,-250,nm\n",
        "# Zernike coefficients in nm, wavelength 0.555 um\npupil_mm,6\nj,c\n4,500\n8,-250\n",
        "pupil_mm,6\nn,m,value,unit\n2,0,0.5,um\n3,1,-0.25,\n",
        "eye,pupil,unit,Z4,Z8\nOD,6,mm,0.5,-0.25\nOS,6,mm,0.5,-0.25\n",
        "j,value,unit,pupil,unit\n4,500,nm,6,mm\n8,-250,nm,6,mm\n",
        "pupil_mm;6\nterm;um\n2,0;0.5\n3,1;-0.25\n",
        "subject,eye,pupil_mm,Z4,Z8\nC22,OD,6,0.5,-0.25\nC22,OS,6,0.5,-0.25\n",
        "pupil_mm,6\nterm,um,comment\nZ2_0,0.5,c22\nZ3_1,-0.25,\n",
        "pupil_mm,6\n\"n\",\"m\",\"Right Eye\",\"Left Eye\"\n2,0,0.5,0.5\n3,1,-0.25,-0.25\n"));

TEST_P(Layouts, HoldTheSameEye) {
  const MeasuredEyes eyes = read(GetParam());
  expectTheEye(eyes.left);
  expectTheEye(eyes.right);
}

TEST(WavefrontFile, OneEyeMayBeMissing) {
  const MeasuredEyes eyes = read("pupil_mm,6\nj,OS\n4,0.5\n8,-0.25\n");
  EXPECT_FALSE(eyes.right);
  expectTheEye(eyes.left);
  const MeasuredEyes other = read("pupil_mm,6\neye,j,um\nright,4,0.5\nright,8,-0.25\n");
  EXPECT_FALSE(other.left);
  expectTheEye(other.right);
}

TEST(WavefrontFile, ThePupilOfTheKeyCountsWhereTheFileHasNone) {
  expectTheEye(read("j,um\n4,0.5\n8,-0.25\n", 6.0).right);
  expectTheEye(read("pupil_mm,6\nj,um\n4,0.5\n8,-0.25\n", 5.0).right);
}

TEST(WavefrontFile, RefusesUnitsThatCanBeMisread) {
  const std::string table = "pupil_mm,6\nj,value\n4,0.5\n";
  for (const std::string comment :
       {"Zernike coefficients in waves at 555 nm", "units: waves", "unit: lambda", "values in λ"}) {
    EXPECT_NE(refusal("# " + comment + "\n" + table).find(": expected micrometres, not waves"),
              std::string::npos)
        << comment;
  }
  EXPECT_EQ(refusal("pupil_mm,6\nn,m,value,unit\n4,0,0.5,waves\n"),
            "eye.csv:3: \"waves\": expected micrometres, not waves");
  EXPECT_EQ(refusal("pupil_mm,6\nn,m,value,unit\n4,0,0.5,D\n"),
            "eye.csv:3: unit = \"D\": expected um or nm");
  EXPECT_EQ(refusal("pupil_mm,6\nunits,waves\nj,c\n4,0.5\n"),
            "eye.csv:2: \"waves\": expected micrometres, not waves");
  EXPECT_EQ(refusal("pupil_mm,6\nj,coefficient (mm)\n4,0.5\n"),
            "eye.csv:2: \"coefficient (mm)\": expected um or nm, not mm");
  EXPECT_EQ(refusal("units,nm\npupil_mm,6\nj,um\n4,0.5\n"),
            "eye.csv:3: \"um\": a second unit: expected one for each coefficient");
  EXPECT_EQ(refusal("Unit 3 Eye Clinic, 2024\npupil_mm,6\nj,um\n4,0.5\n"),
            "eye.csv:1: index = \"Unit 3 Eye Clinic\": expected a number");
  EXPECT_EQ(refusal("wavelength_nm,555\n" + table),
            "eye.csv:1: a wavelength, as for waves, and no unit: expected a heading um or nm");
}

TEST(WavefrontFile, ACommentThatOnlyHoldsAUnitStatesNone) {
  for (const std::string comment :
       {"RMS wavefront error: 85 nm", "RMS wavefront error: 0.25 waves",
        "Zernike coefficients, wavelength (nm): 555", "Zernike coefficients; aperture (mm) below",
        "Wavefront coefficients, pupil coordinates x and y in mm", "lambda_nm: 555",
        "Zernike coefficients for 555-nm light", "Zernike coefficients, wavelength 0.84 um",
        "wavefront error relative to a plane wave, um", "values over a pupil with radius (mm)",
        "Zernike coefficients in um, not in waves", "Wavefront sensor wavelength [nm]: 840",
        "errors: none; grid step 0.2 mm", "units: um, D for refraction"}) {
    expectTheEye(read("# " + comment + "\npupil_mm,6\nj,value\n4,0.5\n8,-0.25\n").right);
  }
  for (const std::string comment : {"unit = nm", "OSA; units: nm", "coefficients [nm], OSA"}) {
    expectTheEye(read("# " + comment + "\npupil_mm,6\nj,value\n4,500\n8,-250\n").right);
  }
}

TEST(WavefrontFile, RefusesTermsThatCanBeMisread) {
  EXPECT_EQ(refusal("eye,pupil_mm,Z12,Z12\nOD,6,0.5,0.1\n"),
            "eye.csv:1: term 12 a second time: expected each term once");
  for (const char* table : {"Z20,Z22,Z40\n0.5,0.1,0.1\n", "Z20,0.5\nZ22,0.1\n",
                            "Z40_um,pupil\n1,6\n", "term,um\nC_31,0.5\nC_33,0.1\n"}) {
    EXPECT_NE(refusal(std::string("pupil_mm,6\n") + table).find(": an index, or n and m? expected"),
              std::string::npos)
        << table;
  }
  EXPECT_EQ(refusal("pupil_mm,6\nZ20_um,Z3-1_um,Z11_um\n0.5,0.1,0\n"), "read");
  EXPECT_EQ(refusal("pupil_mm,6\nZ4,Z11\n0.5,0.1\n"), "read");
  EXPECT_EQ(refusal("pupil_mm,6\nterm,um\nZ11,0.2\n"), "read");
  EXPECT_EQ(refusal("pupil_mm;6\nterm;um\n2,0;0,5\n"),
            "eye.csv:3: index \"2,0\": expected 0 to 65, or a name such as Z2_0");
}

TEST(WavefrontFile, RefusesWhatCanBeMisread) {
  EXPECT_EQ(refusal("j,um\n4,0.5\n"),
            "eye.csv: no pupil: expected a row such as pupil_mm,6, a column pupil_mm, or the key "
            "observer.wavefront_pupil_mm");
  EXPECT_NE(refusal("# Zernike order: Noll\npupil_mm,6\nj,um\n4,0.5\n"), "");
  EXPECT_NE(refusal("pupil_mm,6\nNoll index,um\n4,0.5\n"), "");
  for (const char* name : {"# patient: Knoll\n", "# Anna Noll, 1970\n", "# file noll-2.csv\n",
                           "# order: OSA, not Noll\n"}) {
    EXPECT_EQ(refusal(std::string(name) + "pupil_mm,6\nj,um\n4,0.5\n"), "read") << name;
  }
  EXPECT_EQ(refusal("pupil_mm,6\nnoll,um\n4,0.5\n"),
            "eye.csv:2: noll: expected the order of OSA and ANSI Z80.28");
  for (const char* heading : {"j,waves", "n,m,waves"}) {
    EXPECT_EQ(refusal("pupil_mm,6\n" + std::string(heading) + "\n4,0,0.5\n"),
              "eye.csv:2: \"waves\": expected micrometres, not waves");
  }
  EXPECT_EQ(refusal("pupil_mm,6\nj,um\n4,0.5\n4,0.6\n"),
            "eye.csv:4: term 4 a second time: expected each term once");
  EXPECT_EQ(refusal("pupil_mm,6\nj,um\n66,0.5\n"),
            "eye.csv:3: term 66: expected at most order 10, indices 0 to 65");
  EXPECT_EQ(refusal("pupil_mm,6\nn,m,um\n3,0,0.5\n"),
            "eye.csv:3: n, m = 3, 0: expected a term up to order 10, |m| at most n, n - m even");
  EXPECT_EQ(refusal("pupil_mm,6\nj,um\n4,half\n"),
            "eye.csv:3: coefficient = \"half\": expected a number");
  EXPECT_EQ(refusal("pupil_mm,6\nj,um\n4,500\n"),
            "eye.csv:3: coefficient 500 um: expected at most 50; a heading nm would make it "
            "nanometres");
  EXPECT_EQ(refusal("pupil_mm,60\nj,um\n4,0.5\n"),
            "eye.csv:1: pupil = \"60\": expected a diameter of 1 to 12 mm");
  EXPECT_EQ(refusal("eye,pupil_mm,Z4,Z5\nOD,6,0.5,0\nOD,6,0.6,0\n"),
            "eye.csv:3: a second row of one eye: expected one row for each eye");
  EXPECT_EQ(refusal("j,um,pupil_mm\n4,0.5,6\n8,0.5,5\n"),
            "eye.csv:3: a second pupil: expected one for the table");
  EXPECT_EQ(refusal("pupil_mm,6\nj,um\n4\n"), "eye.csv:3: 1 cell: expected at least 2");
  EXPECT_EQ(refusal(""), "eye.csv: no coefficients: expected a table of Zernike coefficients");
}

}  // namespace FOCI_FILE
}  // namespace foci
