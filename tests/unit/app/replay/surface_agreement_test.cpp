#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "app/replay/run_writer.h"

namespace foci {
namespace FOCI_FILE {

/// A fixated frame.
FrameRecord frame(std::optional<double> surface_m, std::optional<double> vergence_D) {
  FrameRecord record{};
  record.eye.state = GazeState::fixation;
  record.eye.surface_distance_m = surface_m;
  if (vergence_D) record.eye.vergence = DioptreEstimate{.value_D = *vergence_D, .error_D = 0.2};
  return record;
}

std::string doubtsOf(const FrameRecord& usual, const FrameRecord& other, int others) {
  FrameStatistics agreement;
  for (int i = 0; i < 100; ++i) agreement.add(i < others ? other : usual);
  std::string doubts;
  for (const std::string& doubt : agreement.doubts()) doubts += doubt + "\n";
  return doubts;
}

TEST(SurfaceAgreement, HasNoDoubtWhereGazeMeetsTheScene) {
  EXPECT_EQ(doubtsOf(frame(1.0, 1.1), frame(std::nullopt, 1.0), 30), "");
  EXPECT_EQ(doubtsOf(frame(1.0, 1.1), frame(1.0, 3.0), 10), "");
}

TEST(SurfaceAgreement, DoubtsAlignmentWithoutASurface) {
  const std::string said = doubtsOf(frame(1.0, 1.0), frame(std::nullopt, 1.0), 60);
  EXPECT_NE(said.find("60 %"), std::string::npos) << said;
  EXPECT_NE(said.find("gaze.scene_offset_m"), std::string::npos) << said;
}

TEST(SurfaceAgreement, DoubtsASurfaceWhereTheEyesDoNotMeet) {
  const std::string said = doubtsOf(frame(1.0, 1.0), frame(0.4, 1.0), 40);
  EXPECT_NE(said.find("vergence_disagrees"), std::string::npos) << said;
}

TEST(SurfaceAgreement, EyesThatDivergeMayBeExchanged) {
  const std::string said = doubtsOf(frame(2.0, 0.4), frame(2.0, -0.6), 70);
  EXPECT_NE(said.find("70 %"), std::string::npos) << said;
  EXPECT_NE(said.find("exchanged"), std::string::npos) << said;
}

TEST(SurfaceAgreement, LeavesOutSaccades) {
  FrameRecord saccade = frame(std::nullopt, std::nullopt);
  saccade.eye.state = GazeState::saccade;
  EXPECT_EQ(doubtsOf(saccade, frame(1.0, 1.0), 20), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
