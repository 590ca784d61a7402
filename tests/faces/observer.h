// An observer in front of a screen with a webcam on top, who looks from target to target. Saccades
// follow a latency, the eyes blink, and the head sways. The state does not depend on the time step.
#pragma once

#include <span>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "tests/faces/face.h"

namespace foci::faces {

struct ShownTarget {
  double from_s = 0.0, to_s = 0.0;
  glm::dvec2 point_m{0.0};  ///< on the screen from its centre, x right, y up, as the observer sees
};

struct Sitting {
  glm::dvec3 head_m{0.0, 0.11, 0.55};  ///< at rest, camera frame
  double camera_above_m = 0.155;       ///< height of the camera above the screen's centre
  double sway_m = 0.008, sway_rad = 0.03;
  double latency_s = 0.2;      ///< from a new target to its saccade
  double blink_every_s = 4.0;  ///< 0: never
  std::uint32_t seed = 1;
};

/// A point of the screen in the camera frame.
glm::dvec3 onScreen_m(const Sitting& sitting, const glm::dvec2& point_m);

class Observer {
 public:
  Observer(const Sitting& sitting, std::vector<ShownTarget> targets);

  Moment at(double time_s) const;
  /// 0: open, 1: shut.
  double closedAt(double time_s) const;

 private:
  Sitting sitting_;
  std::vector<ShownTarget> targets_;
};

}  // namespace foci::faces
