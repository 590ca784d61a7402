// Maps a webcam's view of the eyes to the screen, with the head free to move.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "gaze/webcam/webcam_record.h"

namespace foci {

/// A view while the observer looked at a target.
struct WebcamSample {
  WebcamView view;
  glm::dvec2 target_m{0.0};  ///< on the screen, from its centre
};

/// point = head.xy + camera + head.z tan(gain * head_rad + turn(eye)),
/// turn = a polynomial of the eye's offset without the head's roll: 1, x, y, x y, x^2, y^2 for each
/// axis.
struct WebcamMap {
  static constexpr std::size_t kTurnTerms = 6;
  static constexpr std::size_t kParameters = 2 * kTurnTerms + 4;
  /// Turn along x, turn along y (radians), gain of yaw and pitch, the camera's place in metres.
  std::array<double, kParameters> parameters{};
  /// Inverse covariance of the parameters, row-major: the certainty that later samples must
  /// outweigh.
  std::vector<double> information;
  double sd_deg = 0.0;  ///< deviation of one view's error, per axis
};

/// The map before any calibration: an eyeball of radius 12 mm, an eye 30 mm wide, the camera 15 cm
/// above the centre of the screen. Its deviations are wide.
WebcamMap nominalWebcamMap();

/// Robust ridge regression towards `prior`: Ceres minimises the angles between points and targets
/// under Cauchy's loss. A first calibration uses the nominal map as prior; clicks use the
/// calibrated map.
/// @param trust  factor on the prior's information, 0 to 1: below 1 old samples fade
/// @throws InputError where a view is not finite, its head is not in front of the screen, or Ceres
///   finds no usable solution
WebcamMap fitWebcamMap(std::span<const WebcamSample> samples, const WebcamMap& prior,
                       double trust = 1.0);

/// Point of the screen that the observer looks at, in metres from its centre. Never fails.
glm::dvec2 pointOnScreen_m(const WebcamMap& map, const WebcamView& view);

}  // namespace foci
