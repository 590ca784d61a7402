// Features of a webcam's frame. A calibration maps them to gaze.
#pragma once

#include <glm/glm.hpp>

namespace foci {

/// The axes are those of the screen, as the observer sees it: x to the right, y up, z towards the
/// observer.
struct WebcamView {
  /// Offset of the iris from its place at rest, in widths of the eye; the mean of both eyes.
  glm::dvec2 eye{0.0};
  glm::dvec3 head_m{0.0, 0.0, 0.6};  ///< midpoint of the eyes, from the camera; z > 0
  glm::dvec2 head_rad{0.0};          ///< yaw to the right, pitch upwards
  double roll_rad = 0.0;             ///< of the head, clockwise as the observer feels it
};

}  // namespace foci
