// BIDS recordings of two eyes, each in a file of its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

class TwoEyes : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write("eye1", "left", 400.0, 0.0);
    write("eye2", "right", 420.0, 0.0004);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file(const std::string& eye) const {
    return folder_ / ("sub-1_task-look_recording-" + eye + "_physio.tsv");
  }

  /// @param late_s  after the other eye's clock
  void write(const std::string& eye, const std::string& name, double x_px, double late_s) const {
    std::ofstream json(folder_ / ("sub-1_task-look_recording-" + eye + "_physio.json"));
    json << R"({"PhysioType": "eyetrack", "SamplingFrequency": 500, "RecordedEye": ")" << name
         << R"(", "Columns": ["timestamp", "x_coordinate", "y_coordinate"],
                "timestamp": {"Units": "s"}, "x_coordinate": {"Units": "pixel"},
                "y_coordinate": {"Units": "pixel"}})";
    std::ofstream tsv(file(eye));
    for (int i = 0; i < 300; ++i) {
      const bool lost = eye == "eye2" && i >= 100 && i < 110;
      tsv << i * 0.002 + late_s << '\t';
      if (lost) {
        tsv << "n/a\tn/a\n";
      } else {
        tsv << x_px + i << "\t250\n";
      }
    }
  }

  fs::path folder_ = fs::temp_directory_path() / ("foci_eyes_" + std::to_string(getpid()));
};

/// A recording of two samples at (0.25, 0.125), in `unit`.
class Origin : public TwoEyes {
 protected:
  fs::path recording(const std::string& origin, const std::string& unit = "pixel",
                     const std::string& resolution = "[1000, 500]") const {
    std::ofstream json(folder_ / "sub-2_physio.json");
    json
        << R"({"Columns": ["timestamp", "x_coordinate", "y_coordinate"], "x_coordinate": {"Units": ")"
        << unit << R"("}, "y_coordinate": {"Units": ")" << unit
        << R"("}, "timestamp": {"Units": "s"}, "StimulusPresentation": {"ScreenOrigin": )" << origin
        << R"(, "ScreenResolution": )" << resolution << "}}";
    std::ofstream(folder_ / "sub-2_physio.tsv") << "0\t0.25\t0.125\n0.01\t0.25\t0.125\n";
    return folder_ / "sub-2_physio.tsv";
  }

  static std::string refusal(const fs::path& file) {
    try {
      readTrace(file, {}, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  }
};

TEST_F(Origin, IsALeftCornerOfTheScreen) {
  const auto point = [&](const fs::path& file, const TraceColumns& columns = {}) {
    return *readTrace(file, columns, {}).samples[0].point_px;
  };
  EXPECT_EQ(point(recording(R"(["top", "left"])")), glm::dvec2(0.25, 0.125));
  EXPECT_EQ(point(recording(R"(["bottom", "left"])")), glm::dvec2(0.25, 499.875));
  EXPECT_EQ(point(recording(R"(["bottom", "left"])", "normalized")), glm::dvec2(250, 437.5));
  EXPECT_EQ(refusal(recording(R"(["bottom", "left"])", "degree")), "not refused");
  const glm::dvec2 in_degrees = point(recording(R"(["bottom", "left"])", "degree"));
  for (const char* unit :
       {"visual angle", "deg (visual angle)", "Visual angle (deg)", "\xc2\xb0"}) {
    EXPECT_EQ(point(recording(R"(["bottom", "left"])", unit)), in_degrees) << unit;
  }
  EXPECT_EQ(point(recording(R"(["bottom", "right"])")), glm::dvec2(999.75, 499.875));
  const fs::path centre = recording(R"(["center", "center"])");
  EXPECT_EQ(point(centre), glm::dvec2(500.25, 249.875));
  EXPECT_NE(readTrace(centre, {}, {}).assumed[0].find("upwards"), std::string::npos);
  EXPECT_EQ(point(centre, {.scale = {1, 1}, .offset = {500, 250}}), glm::dvec2(500.25, 250.125));
  EXPECT_NE(refusal(recording(R"(["bottom", "left"])", "pixel", "[0, 0]")).find("ScreenResolution"),
            std::string::npos);
  EXPECT_NE(refusal(recording("3")).find("ScreenOrigin"), std::string::npos);
}

/// A data set whose metadata stand higher up, as in the official examples.
class DataSet : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(beh_);
    write("dataset_description.json", "{}");
    write("task-look_physio.json", R"({"PhysioType": "eyetrack", "SamplingFrequency": 250,
      "Columns": ["timestamp", "x_coordinate", "y_coordinate", "pupil_size"],
      "timestamp": {"Units": "ms"}, "x_coordinate": {"Units": "pixel"},
      "y_coordinate": {"Units": "pixel"}, "pupil_size": {"Units": "a.u."}})");
    write("task-rest_physio.json", R"({"Columns": ["wrong"]})");
    write("task-look_events.json", R"({"StimulusPresentation": {"ScreenDistance": 0.9,
      "ScreenOrigin": ["top", "left"], "ScreenResolution": [800, 600], "ScreenSize": [0.4, 0.3]}})");
    write("sub-01/beh/sub-01_task-look_recording-eye1_physio.json", R"({"RecordedEye": "left"})");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(root_ / name) << text;
  }
  fs::path recording(const std::string& rows) const {
    write("sub-01/beh/sub-01_task-look_recording-eye1_physio.tsv", rows);
    return beh_ / "sub-01_task-look_recording-eye1_physio.tsv";
  }

  fs::path root_ = fs::temp_directory_path() / ("foci_set_" + std::to_string(getpid()));
  fs::path beh_ = root_ / "sub-01" / "beh";
};

constexpr const char* kRows = "5000\t400\t100\t1200\n5004\t401\t101\t1201\n";

TEST_F(DataSet, MetadataAreInheritedAndTheScreenIsThatOfTheEvents) {
  const GazeTrace trace = readTrace(recording(kRows), {}, kScreen);
  EXPECT_EQ(trace.rate_Hz, 250.0);
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(800, 600));
  EXPECT_EQ(trace.screen->size_m, glm::dvec2(0.4, 0.3));
  EXPECT_EQ(trace.screen->distance_m, 0.9);
  EXPECT_TRUE(trace.assumed.empty()) << trace.assumed[0];
  EXPECT_EQ(*trace.samples[0].eyes[0].point_px, glm::dvec2(400, 100));
  EXPECT_EQ(trace.samples[0].pupil_own, 1200.0);
  EXPECT_EQ(companionsOf(recording(kRows)).size(), 3u);
}

TEST_F(DataSet, AByteOrderMarkAndALineOfNamesAreSkipped) {
  const std::string mark = "\xef\xbb\xbf";
  EXPECT_EQ(readTrace(recording(mark + kRows), {}, {}).samples.size(), 2u);
  const std::string names = "timestamp\tx_coordinate\ty_coordinate\tpupil_size\n";
  EXPECT_EQ(readTrace(recording(mark + names + kRows), {}, {}).samples.size(), 2u);
}

TEST_F(DataSet, WhatIsNoScreenOrNoRateIsSaid) {
  std::string rows;
  for (int i = 0; i < 300; ++i) rows += std::to_string(5000 + 2 * i) + "\t400\t100\t1200\n";
  const auto said = [&] {
    std::string text;
    for (const std::string& warning : readTrace(recording(rows), {}, {}).warnings) text += warning;
    return text;
  };
  EXPECT_NE(said().find("sampling rate is 250 Hz, but there are 500"), std::string::npos);
  EXPECT_EQ(said().find("is left out"), std::string::npos);
  write("task-look_events.json", R"({"StimulusPresentation": {"ScreenDistance": 600,
    "ScreenResolution": [800, 600], "ScreenSize": [530, 300]}})");
  EXPECT_NE(said().find("ScreenSize is [530,300]"), std::string::npos) << said();
  EXPECT_NE(said().find("ScreenDistance is 600"), std::string::npos) << said();
  write("sub-01/beh/sub-01_task-look_recording-eye1_physio.json",
        R"({"RecordedEye": "left", "SampleCoordinateSystem": "eye-in-head"})");
  EXPECT_THROW(readTrace(recording(rows), {}, {}), InputError);
}

TEST_F(DataSet, AnEmptyFileIsNamedWithItsMetadata) {
  const auto refusal = [&](const std::string& rows) -> std::string {
    try {
      readTrace(recording(rows), {}, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  };
  for (const char* part : {"has no rows", "250 Hz", "\"left\"", "x_coordinate [px]", "800 x 600 px",
                           "0.4 x 0.3 m", "0.9 m away"}) {
    EXPECT_NE(refusal("").find(part), std::string::npos) << refusal("");
  }
}

TEST_F(DataSet, AStudysScreenThatStandsInIsSaid) {
  fs::remove(root_ / "task-look_events.json");
  const GazeTrace trace = readTrace(recording(kRows), {}, kScreen);
  ASSERT_EQ(trace.assumed.size(), 1u);
  EXPECT_NE(trace.assumed[0].find("screen.distance_m"), std::string::npos) << trace.assumed[0];
}

TEST_F(TwoEyes, AreOneRecording) {
  for (const char* eye : {"eye1", "eye2"}) {
    const GazeTrace trace = readTrace(file(eye), {}, kScreen);
    EXPECT_EQ(trace.format, "BIDS eye tracking, binocular");
    ASSERT_EQ(trace.samples.size(), 300u);
    EXPECT_TRUE(trace.warnings.empty()) << trace.warnings.front();
    const GazeSample& sample = trace.samples[50];
    ASSERT_TRUE(sample.eyes[0].point_px && sample.eyes[1].point_px && sample.point_px);
    EXPECT_EQ(sample.eyes[0].point_px->x, 450.0) << eye;
    EXPECT_EQ(sample.eyes[1].point_px->x, 470.0) << eye;
    EXPECT_EQ(sample.point_px->x, 460.0) << eye;
    // The point does not jump while one eye is lost.
    ASSERT_TRUE(trace.samples[105].point_px);
    EXPECT_FALSE(trace.samples[105].eyes[1].point_px);
    EXPECT_NEAR(trace.samples[105].point_px->x, 515.0, 0.01) << eye;
  }
}

TEST_F(TwoEyes, AreReadWithTheirCompanions) {
  EXPECT_EQ(companionsOf(file("eye1")).size(), 3u);
  fs::remove(file("eye2"));
  EXPECT_EQ(companionsOf(file("eye1")).size(), 1u);
  EXPECT_FALSE(readTrace(file("eye1"), {}, kScreen).samples[50].eyes[1].point_px);
}

TEST_F(TwoEyes, AreRefusedUnlessOneIsLeftAndOneRight) {
  for (const char* name : {"left", "cyclopean"}) {
    write("eye2", name, 420.0, 0.0);
    EXPECT_THROW(readTrace(file("eye1"), {}, kScreen), InputError) << name;
  }
}

TEST_F(TwoEyes, HaveANameForEachColumn) {
  for (const char* row : {"0\t1\n0.01\t1\n", "0\t1\t2\t3\n0.01\t1\t2\t3\n"}) {
    std::ofstream(file("eye1")) << row;
    const std::string said = refusalBy([&] { readTrace(file("eye1"), {}, kScreen); });
    EXPECT_NE(said.find("Columns names 3"), std::string::npos) << said;
  }
}

TEST_F(TwoEyes, OfDifferentClocksRaiseADoubt) {
  write("eye2", "right", 420.0, 100.0);
  const GazeTrace trace = readTrace(file("eye1"), {}, kScreen);
  ASSERT_FALSE(trace.warnings.empty());
  EXPECT_NE(trace.warnings.front().find("clocks"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
