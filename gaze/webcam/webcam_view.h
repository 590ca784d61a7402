// What a webcam's image says of the observer: the features that gaze is mapped from.
#pragma once

#include <glm/glm.hpp>

namespace foci {

/// The axes are the screen's, as the observer sees it: x to the right, y up, z towards the
/// observer.
struct WebcamView {
  glm::dvec2 eye{
      0.0};  ///< iris from the middle between the eye's corners, in eye widths; mean of both eyes
  glm::dvec3 head_m{0.0, 0.0, 0.6};  ///< between the eyes, from the camera; z > 0
  glm::dvec2 head_rad{0.0};          ///< yaw to the right, pitch upwards
  double roll_rad = 0.0;             ///< of the head, clockwise as the observer feels it
};

}  // namespace foci
