#include "app/replay/replay_inputs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

/// The record of a run at 62.5 frames per second that was asked for 15.
Study record(const std::filesystem::path& folder, const std::string& rows) {
  std::ofstream(folder / "frames.tsv") << "time_s\tmethod\n" << rows;
  std::ofstream(folder / "gaze.tsv") << "time_s\tx_px\ty_px\n0\t320\t240\n0.1\t320\t240\n";
  Study study;
  study.gaze.source = (folder / "gaze.tsv").string();
  study.record.frames = folder / "frames.tsv";
  study.output.fps = 15.0;
  return study;
}

TEST(Schedule, OfAKilledRecordHasTheMeanRateOfItsFrames) {
  Warnings warnings;
  const TemporaryFolder scratch;
  const Study study =
      record(scratch.path(), "0.010\tpinhole\n0.020\tpinhole\n0.040\tpinhole\n0.058\tpinhole\n");
  const ReplayedGaze gaze = readReplayedGaze(study, warnings);
  EXPECT_EQ(gaze.schedule.fps, 62.5);
  EXPECT_EQ(gaze.study.output.fps, 62.5);  // of the video, the report and the manifest
  EXPECT_EQ(gaze.schedule.frames, 4u);
  EXPECT_EQ(gaze.schedule.time_s(2), 0.04);
}

TEST(Schedule, OfASingleRecordedFrameKeepsTheRateOfTheStudy) {
  Warnings warnings;
  const TemporaryFolder scratch;
  const Study study = record(scratch.path(), "0.010\tpinhole\n");
  EXPECT_EQ(readReplayedGaze(study, warnings).schedule.fps, 15.0);
}

}  // namespace FOCI_FILE
}  // namespace foci
