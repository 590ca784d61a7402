// Events in recordings with head poses: they are those of the gaze in the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gaze/events/gaze_events.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRate_Hz = 120.0, kSaccade_deg = 12.0;

/// A head that swings by 25 degrees to each side, at up to 79 deg/s. Gaze rests on a point, and
/// after 2 s on another one, 12 degrees above it.
GazeTrace swingingHead() {
  GazeTrace trace{{.format = "simulated", .screen = headsetScreen({}, 12.0)}, kRate_Hz};
  for (int i = 0; i < 480; ++i) {
    const double time_s = i / kRate_Hz;
    const double yaw_rad = glm::radians(25.0) * std::sin(M_PI * time_s);
    GazeSample sample{.time_s = time_s, .head = HeadInWorld{}};
    sample.head->world_from_head = glm::angleAxis(yaw_rad, glm::dvec3(0.0, 1.0, 0.0));
    const double up_rad = time_s < 2.0 ? 0.0 : glm::radians(kSaccade_deg);
    const glm::dvec3 world(0.0, std::sin(up_rad), -std::cos(up_rad));
    sample.direction = glm::conjugate(sample.head->world_from_head) * world;
    sample.point_px = pointOnScreen_px(*trace.screen, *sample.direction);
    trace.samples.push_back(sample);
  }
  return trace;
}

TEST(EventsOfAHeadset, AreThoseOfGazeInTheWorld) {
  const GazeTrace trace = swingingHead();
  const auto events = detectEvents(trace, *trace.screen);
  const auto saccade = std::find_if(events.begin(), events.end(), [](const GazeEvent& event) {
    return event.kind == GazeState::saccade;
  });
  ASSERT_NE(saccade, events.end());
  EXPECT_NEAR(saccade->onset_s, 2.0, 0.03);
  EXPECT_NEAR(*saccade->amplitude_deg, kSaccade_deg, 0.1);
  const auto count = [&](GazeState kind) {
    return std::count_if(events.begin(), events.end(),
                         [&](const GazeEvent& event) { return event.kind == kind; });
  };
  EXPECT_EQ(count(GazeState::saccade), 1);
  EXPECT_EQ(count(GazeState::fixation), 2);
  EXPECT_EQ(count(GazeState::pursuit), 0);
}

}  // namespace FOCI_FILE
}  // namespace foci
