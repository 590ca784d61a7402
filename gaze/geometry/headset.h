// The display of a headset as a screen that moves with the head.
#pragma once

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Pixels per degree in the middle of a headset's view, if none are stated. Chosen by hand: half
/// of a usual headset's, so that a replay is quick.
inline constexpr double kHeadsetPixelsPerDegree = 12.0;

/// The field of an eye midway between both, which sees what either eye sees.
/// @param left_eye  the right eye's field is its mirror image
EyeField fieldOfBothEyes(const EyeField& left_eye);

/// A screen at one metre that fills the field. A plane's scale grows to the side; its middle has
///   R = p 180/pi pixels per tangent.
/// Width and height are even numbers of pixels.
/// @param pixels_per_degree  p, at the faced point
Screen headsetScreen(const EyeField& field, double pixels_per_degree);

}  // namespace foci
