// Statistics of the times of a live run.
#include "app/record/live_facts.h"

#include <gtest/gtest.h>

namespace foci {
namespace FOCI_FILE {

TEST(Durations, QuantilesAreThoseOfTheBins) {
  Durations durations;
  EXPECT_EQ(durations.quantile_ms(0.5), 0.0);
  for (int i = 1; i <= 100; ++i) durations.add(i);
  constexpr double kBin_ms = 0.1;
  EXPECT_NEAR(durations.quantile_ms(0.5), 51.0, kBin_ms);
  EXPECT_NEAR(durations.quantile_ms(0.95), 96.0, kBin_ms);
}

TEST(Landings, LastFromTheSampleThatLandedToTheFirstFullFrame) {
  Landings landings;
  const auto show = [&](GazeState state, double state_s, bool full, double swap_s) {
    FrameRecord record;
    record.eye.state = state;
    record.eye.state_time_s = 1000.0 + state_s;  // a recording has a clock of its own
    return landings.add(record, state_s, full, swap_s);
  };
  constexpr double kRounding_ms = 1e-9;
  EXPECT_FALSE(show(GazeState::fixation, 0.0, true, 0.1));  // no saccade was before
  EXPECT_FALSE(show(GazeState::saccade, 0.2, true, 0.22));
  EXPECT_FALSE(show(GazeState::fixation, 0.25, false, 0.27));
  EXPECT_NEAR(show(GazeState::fixation, 0.26, true, 0.29).value_or(0.0), 40.0, kRounding_ms);
  EXPECT_FALSE(show(GazeState::fixation, 0.28, true, 0.31));  // the first alone counts
  show(GazeState::saccade, 0.4, false, 0.42);
  show(GazeState::fixation, 0.5, false, 0.52);
  show(GazeState::blink, 0.6, false, 0.62);
  EXPECT_FALSE(show(GazeState::fixation, 0.7, true, 0.72));  // it was never full before it left
  EXPECT_EQ(landings.count(), 2u);
  EXPECT_EQ(landings.toFull().count(), 1u);
  EXPECT_DOUBLE_EQ(landings.fullShare(), 5.0 / 9.0);
}

}  // namespace FOCI_FILE
}  // namespace foci
