// Trials from the messages of a recording, and from the events of a BIDS data set.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "gaze/sources/trace_reader.h"
#include "gaze/sources/trace_summary.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

TEST(TrialsIn, EndWithTheirResultTheNextTrialOrTheRecording) {
  const auto trials = trialsIn({{1.0, "TRIALID 7 left"},
                                {1.5, "!V TRIAL_VAR contrast 0.5 high"},
                                {2.0, "TRIAL_RESULT 1"},
                                {2.5, "!V TRIAL_VAR outside 1"},
                                {3.0, "TRIALID"},
                                {4.0, "TRIALID 9"}},
                               kTrialMessage, 6.0);
  ASSERT_EQ(trials.size(), 3u);
  EXPECT_EQ(trials[0].name, "7 left");
  EXPECT_EQ(trials[0].last_s, 2.0);
  EXPECT_EQ(trials[0].result, "1");
  ASSERT_EQ(trials[0].variables.size(), 1u);
  EXPECT_EQ(trials[0].variables[0].second, "0.5 high");
  EXPECT_EQ(trials[1].name, "TRIALID");
  EXPECT_EQ(trials[1].last_s, 4.0);
  EXPECT_EQ(trials[2].last_s, 6.0);
  EXPECT_EQ(trialsIn({{1.0, "picture cat.png"}, {2.0, "key"}}, "picture", 3.0)[0].name, "cat.png");
  EXPECT_TRUE(trialsIn({{1.0, "TRIAL_RESULT 0"}}, "TRIAL", 3.0).empty());
}

TEST(TrialAt, IsTheOneThatBeganLast) {
  const std::vector<TraceTrial> trials{{.name = "block", .first_s = 0.0, .last_s = 10.0},
                                       {.name = "1", .first_s = 2.0, .last_s = 3.0},
                                       {.name = "2", .first_s = 5.0, .last_s = 11.0}};
  EXPECT_EQ(trialAt(trials, -1.0), "n/a");
  EXPECT_EQ(trialAt(trials, 2.0), "1");
  EXPECT_EQ(trialAt(trials, 3.0), "block");
  EXPECT_EQ(trialAt(trials, 10.5), "2");
  EXPECT_EQ(trialAt(trials, 11.0), "n/a");
  EXPECT_EQ(trialAt({}, 1.0), "n/a");
}

/// A recording from 100 to 102 s, whose task began after half a second.
class BidsTrials : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write("_physio.json",
          R"({"SamplingFrequency": 100, "StartTime": -0.5,
              "Columns": ["timestamp", "x_coordinate", "y_coordinate"],
              "timestamp": {"Units": "s"}, "x_coordinate": {"Units": "pixel"},
              "y_coordinate": {"Units": "pixel"}})");
    std::string rows;
    for (int i = 0; i <= 200; ++i) rows += std::to_string(100.0 + 0.01 * i) + "\t400\t300\n";
    write("_physio.tsv", rows);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& ending, const std::string& text) const {
    std::ofstream(folder_ / ("sub-1_task-look" + ending)) << text;
  }
  GazeTrace read() const { return readTrace(folder_ / "sub-1_task-look_physio.tsv", {}, kScreen); }

  const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};
  fs::path folder_ = fs::temp_directory_path() / ("foci_trials_" + std::to_string(getpid()));
};

TEST_F(BidsTrials, CountFromTheStartOfTheTask) {
  write("_events.tsv", "onset\tduration\ttrial_type\n0\t0.4\tface\n0.5\tn/a\thouse\n1\t9\tface\n");
  const GazeTrace trace = read();
  ASSERT_EQ(trace.trials.size(), 3u);
  EXPECT_EQ(trace.trials[0].name, "1");
  EXPECT_EQ(trace.trials[0].type, "face");
  EXPECT_NEAR(trace.trials[0].first_s, 100.5, 1e-9);
  EXPECT_NEAR(trace.trials[0].last_s, 100.9, 1e-9);
  EXPECT_NEAR(trace.trials[1].last_s, 101.5, 1e-9);
  EXPECT_TRUE(trace.warnings.empty());
}

TEST_F(BidsTrials, MayBeOnTheRecordingsOwnClock) {
  write("_events.tsv", "onset\tduration\ttrial_number\n100.25\t0.5\t12\n");
  const GazeTrace trace = read();
  ASSERT_EQ(trace.trials.size(), 1u);
  EXPECT_EQ(trace.trials[0].name, "12");
  EXPECT_EQ(trace.trials[0].first_s, 100.25);
  std::string assumed;
  for (const std::string& each : trace.assumed) assumed += each + "; ";
  EXPECT_NE(assumed.find("own clock"), std::string::npos) << assumed;
}

TEST_F(BidsTrials, AreDoubtedIfNoneLiesWithinTheRecording) {
  write("_events.tsv", "onset\tduration\n5000\t1\n");
  const GazeTrace trace = read();
  EXPECT_TRUE(trace.trials.empty());
  ASSERT_EQ(trace.warnings.size(), 1u);
  EXPECT_NE(trace.warnings[0].find("sub-1_task-look_events.tsv"), std::string::npos);
}

TEST_F(BidsTrials, AndMarkersComeFromMessages) {
  write("_physioevents.json", R"({"Columns": ["onset", "duration", "blink", "message"]})");
  write("_physioevents.tsv",
        "100.2\t0\tn/a\tTRIALID 4\n100.3\t0.1\t1\tn/a\n101\t0\tn/a\tTRIAL_RESULT 0\n");
  const GazeTrace trace = read();
  ASSERT_EQ(trace.markers.size(), 2u);
  EXPECT_EQ(trace.markers[0].text, "TRIALID 4");
  ASSERT_EQ(trace.trials.size(), 1u);
  EXPECT_EQ(trace.trials[0].last_s, 101.0);
}

}  // namespace FOCI_FILE
}  // namespace foci
