// From a webcam's view of the eyes to the screen, with the head free to move.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "gaze/webcam/webcam_view.h"

namespace foci {

struct WebcamSample {
  WebcamView view;
  glm::dvec2 target_m{0.0};  ///< on the screen, from its centre
};

/// point = head.xy + camera + head.z tan(gain * head_rad + turn(eye)),
/// turn = a polynomial of the eye's offset, roll taken out: 1, x, y, x y, x^2, y^2 for each axis.
struct WebcamMap {
  static constexpr std::size_t kTurnTerms = 6;
  static constexpr std::size_t kParameters = 2 * kTurnTerms + 4;
  /// Turn along x, turn along y (radians), gain of yaw and pitch, the camera's place in metres.
  std::array<double, kParameters> parameters{};
  /// Inverse covariance of the parameters, row-major: what later samples have to outweigh.
  std::vector<double> information;
  double sd_deg = 0.0;  ///< of one view's error, per axis
};

/// Before any calibration: an eyeball of 12 mm behind an eye 30 mm wide, the camera 15 cm above the
/// centre of the screen, all of it known loosely.
WebcamMap nominalWebcamMap();

/// The map that `samples` and the knowledge in `prior` together bear (Ceres; Huber's loss in
/// degrees): ridge regression towards the prior. A first calibration starts from the nominal map;
/// clicks, whose place the observer looked at, from the map in use.
/// @param trust  of the prior's information, 0 to 1: below 1 old samples fade
/// @throws InputError where a view is not finite or its head is not in front of the screen
WebcamMap fitWebcamMap(std::span<const WebcamSample> samples, const WebcamMap& prior,
                       double trust = 1.0);

/// Where on the screen, in metres from its centre. Never fails.
glm::dvec2 pointOnScreen_m(const WebcamMap& map, const WebcamView& view);

}  // namespace foci
