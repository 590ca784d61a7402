// `foci eye` and `foci validate`, and studies of an observer with measured eyes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

class Eye : public testing::Test {
 protected:
  Eye() {
    folder.write("eyes.csv", "pupil_mm,6\nj,OD_um,OS_um\n4,0.5,0.3\n8,0.2,-0.2\n12,0.15,0.1\n");
    folder.write("study.toml", study("wavefront = \"eyes.csv\"\npupil_mm = 4\n"));
  }

  static std::string study(const std::string& observer) {
    return "[scene]\nbuiltin = \"gallery\"\n[screen]\nsize_px = [96, 72]\n[observer]\n" + observer;
  }

  /// Values of eye.tsv by eye, figure and place.
  std::map<std::string, double> figures(const std::string& file) const {
    std::map<std::string, double> values;
    std::istringstream lines(folder.read(file));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      std::string eye, figure, at, unit, value;
      std::getline(cells, eye, '\t');
      std::getline(cells, figure, '\t');
      std::getline(cells, at, '\t');
      std::getline(cells, unit, '\t');
      std::getline(cells, value, '\t');
      values[eye + "/" + figure + "/" + at] = std::stod(value);
    }
    return values;
  }

  TemporaryFolder folder;
};

TEST_F(Eye, ReportsBothEyesOfAnAberrometer) {
  const Outcome outcome = runFoci(
      {"eye", "study.toml", "--out", "eye", "--focus", "1", "--at", "1,inf"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto values = figures("eye/eye.tsv");
  EXPECT_NEAR(values.at("left eye/pupil/"), 4.0, 1e-9);
  EXPECT_NEAR(values.at("left eye/focus/"), 1.0, 1e-9);
  // From 6 to 4 mm, orders 3 and 4 fall with the cube and the fourth power of 2/3.
  const double coma_um = 0.2 * std::pow(2.0 / 3.0, 3), right_um = 0.15 * std::pow(2.0 / 3.0, 4);
  EXPECT_NEAR(values.at("right eye/rms/orders 3 and up"), std::hypot(coma_um, right_um), 1e-5);
  EXPECT_GT(values.at("left eye/strehl/1 D"), 5.0 * values.at("left eye/strehl/0 D"));
  EXPECT_NEAR(values.at("left eye/mtf_white/0 cycles/deg"), 1.0, 1e-6);
  EXPECT_NEAR(values.at("left eye/depth_of_focus/80 % at 10 cycles/deg"), 0.5, 0.2);
  EXPECT_LT(values.at("left eye/acuity/5 % contrast"), 120.0);
  for (const char* name : {"left_psf_1.png", "left_psf_2.png", "right_wavefront.png", "eye.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "eye" / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "eye" / "left_psf_3.png"));
}

TEST_F(Eye, AnEqualPairIsOneEye) {
  folder.write("plain.toml", study("pupil_mm = 3\n"));
  const Outcome outcome =
      runFoci({"eye", "plain.toml", "--out", "eye", "--at", "0.5"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("left"), std::string::npos);
  EXPECT_NEAR(figures("eye/eye.tsv").at("both eyes/rms/orders 3 and up"), 0.0, 1e-9);
}

TEST_F(Eye, ShowsFieldAngles) {
  folder.write("plain.toml", study("pupil_mm = 3\n"));
  const Outcome outcome = runFoci(
      {"eye", "plain.toml", "--out", "eye", "--at", "0.5,1", "--field", "0,-20,30"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto values = figures("eye/eye.tsv");
  EXPECT_NEAR(values.at("both eyes/mtf_white/0 deg, 10 cycles/deg"),
              values.at("both eyes/mtf_white/10 cycles/deg"), 1e-3);
  EXPECT_GT(values.at("both eyes/mtf_white/0 deg, 10 cycles/deg"),
            2.0 * values.at("both eyes/mtf_white/30 deg, 10 cycles/deg"));
  EXPECT_GT(values.at("both eyes/field_J0/30 deg"), 2.0 * values.at("both eyes/field_J0/-20 deg"));
  for (const char* name : {"both_field_1_psf_2.png", "both_field_3_psf_1.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "eye" / name)) << name;
  }
  const Outcome refused =
      runFoci({"eye", "plain.toml", "--out", "eye", "--overwrite", "--field", "61"}, folder.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("--field 61"), std::string::npos) << refused.err;
}

TEST_F(Eye, RefusesWhatItCannotShow) {
  for (const std::string at : {"0", "-1", "near"}) {
    const Outcome outcome =
        runFoci({"eye", "study.toml", "--out", "eye", "--at=" + at}, folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << at;
    EXPECT_NE(outcome.err.find("--at"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "eye"));
}

TEST_F(Eye, AWavefrontChangesTheFrameAndIsRecorded) {
  const Outcome with = runFoci({"render", "study.toml", "--out", "with.pfm", "--focus", "1",
                                "--pupil", "6", "--method", "sweep-lod"},
                               folder.path());
  ASSERT_EQ(with.exit_code, 0) << with.err;
  const Outcome without =
      runFoci({"render", "study.toml", "--out", "without.pfm", "--focus", "1", "--pupil", "6",
               "--method", "sweep-lod", "--set", "observer.wavefront=null"},
              folder.path());
  ASSERT_EQ(without.exit_code, 0) << without.err;
  EXPECT_NE(folder.read("with.pfm"), folder.read("without.pfm"));
  // A study that foci writes names the file, and gives the same bytes.
  ASSERT_EQ(runFoci({"render", "study.toml", "--out", "again.pfm", "--focus", "1", "--pupil", "6",
                     "--method", "sweep-lod", "--write-study", "saved.toml"},
                    folder.path())
                .exit_code,
            0);
  EXPECT_NE(folder.read("saved.toml").find("wavefront = \"eyes.csv\""), std::string::npos);
  ASSERT_EQ(runFoci({"render", "saved.toml", "--out", "saved.pfm", "--focus", "1"}, folder.path())
                .exit_code,
            0);
  EXPECT_EQ(folder.read("saved.pfm"), folder.read("with.pfm"));
}

TEST_F(Eye, ValidatesAgainstPublishedFigures) {
  const Outcome outcome = runFoci({"validate", "--out", "validation"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string table = folder.read("validation/validation.tsv");
  EXPECT_NE(table.find("Watson and Yellott 2012"), std::string::npos);
  EXPECT_NE(table.find("Atchison, Charman and Woods 1997"), std::string::npos);
  EXPECT_NE(folder.read("validation/validation.html").find("all within their bounds"),
            std::string::npos);
}

TEST_F(Eye, ValidateRefusesAFolderThatCannotBeMadeBeforeItComputes) {
  folder.write("file", "no folder");
  const Fault impatient{.max_s = 5};  // the computation takes longer
  const auto validate = [&](const std::string& out) {
    return runFociUnder(impatient, {"validate", "--out", out}, folder.path());
  };
  const Outcome in_file = validate("file/validation");
  EXPECT_EQ(in_file.exit_code, 2) << in_file.err;
  EXPECT_NE(in_file.err.find("is a file: expected a folder"), std::string::npos) << in_file.err;
  const Outcome refused = validate("/proc/none/validation");
  EXPECT_EQ(refused.exit_code, 1) << refused.err;
  EXPECT_NE(refused.err.find("cannot make the folder"), std::string::npos) << refused.err;
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
