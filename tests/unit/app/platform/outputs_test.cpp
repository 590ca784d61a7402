#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>

#include "app/platform/output_files.h"
#include "app/platform/sha256.h"
#include "app/record/tables.h"
#include "app/replay/report_charts.h"
#include "base/file.h"
#include "base/text.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const std::filesystem::path& root_ = temporary_.path();
};

TEST_F(OutputFolderTest, ShowsFilesOnlyOnceCommitted) {
  const fs::path out = root_ / "a/b";
  OutputFolder folder(out, OutputGuard());
  writeText(folder.stage("one.txt"), "1");
  EXPECT_FALSE(fs::exists(out / "one.txt"));
  folder.commit();
  EXPECT_TRUE(fs::exists(out / "one.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), 2);  // the file, and the list of files
}

TEST_F(OutputFolderTest, LeavesNothingUncommitted) {
  {
    OutputFolder folder(root_ / "a/b/c", OutputGuard());
    writeText(folder.stage("one.txt"), "1");
  }
  EXPECT_FALSE(fs::exists(root_ / "a"));
}

TEST_F(OutputFolderTest, KeepsOlderFiles) {
  fs::create_directories(root_ / "a");
  writeText(root_ / "a/old.txt", "old");
  {
    OutputFolder folder(root_ / "a/b", OutputGuard());
    writeText(folder.stage("one.txt"), "1");
  }
  EXPECT_TRUE(fs::exists(root_ / "a/old.txt"));
  EXPECT_FALSE(fs::exists(root_ / "a/b"));
}

TEST_F(OutputFolderTest, RefusesAFileInItsPlaceAndRemovesNewFolders) {
  writeText(root_ / "file", "");
  EXPECT_THROW(OutputFolder(root_ / "file", OutputGuard()), std::runtime_error);
  EXPECT_THROW(OutputFolder(root_ / "file/below", OutputGuard()), std::runtime_error);
}

std::string sha256Of(std::string_view text) {
  Sha256 hash;
  hash.add({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  return hash.hex();
}

TEST(Sha256, MatchesTheStandardsVectors) {  // FIPS 180-4
  EXPECT_EQ(sha256Of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256Of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Decimal, RoundsWithoutMinusZero) {
  EXPECT_EQ(decimal(1.23456, 2), "1.23");
  EXPECT_EQ(decimal(-0.001, 2), "0.00");
  EXPECT_EQ(decimal(-0.01, 2), "-0.01");
  EXPECT_EQ(decimal(std::numeric_limits<double>::max(), 6).size(), 316u);
}

TEST(EventTable, WritesNaForMissingValues) {
  const GazeEvent fixation{.kind = GazeState::fixation,
                           .onset_s = 1.0,
                           .duration_s = 0.25,
                           .position_px = glm::dvec2(10.0, 20.0),
                           .start_px = {}};
  const std::string table = eventTable({fixation}, {});
  EXPECT_EQ(table.substr(table.find('\n') + 1),
            "fixation\t1.000000\t0.250000\t10.00\t20.00\tn/a\tn/a\tn/a\tn/a\tn/a\n");
}

TEST(ChartSeries, StaysSmallAndEven) {
  ChartSeries series;
  for (int i = 0; i < 100000; ++i) {
    ChartRow row{};
    row.time_s = i;
    series.add([&] { return row; });
  }
  const auto& rows = series.kept();
  EXPECT_LE(rows.size(), 4000u);
  EXPECT_GE(rows.size(), 1000u);
  const double step = rows[1].time_s - rows[0].time_s;
  EXPECT_EQ(rows[0].time_s, 0.0);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].time_s - rows[i - 1].time_s, step) << i;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
