// The observer's pupil over time, as the study chooses it: fixed, the recording's, or the one that
// the light of the pictures gives.
#pragma once

#include <optional>

#include "app/study.h"
#include "gaze/focus/pupil.h"
#include "render/image/frame.h"

namespace foci {

class ObserverPupil {
 public:
  explicit ObserverPupil(const Study& study);

  /// A diameter that the recording tells is held until the next, through blinks and losses.
  void push(const GazeSample& sample);

  /// A picture was shown at `time_s`, not before the last; until the next the eye adapts to it.
  void show(double time_s, const Frame& frame);

  /// Whether the first picture must be known, in any blur, before there is a diameter.
  bool needsPicture() const { return by_light_ && !shown_mm_; }

  /// Millimetres. Not `needsPicture`.
  /// @param time_s  not before the last picture's
  double at_mm(double time_s);

 private:
  double fixed_mm_;
  bool by_light_, recorded_;
  PupilScene scene_;  // of a white picture
  std::optional<double> recorded_mm_{}, shown_mm_{};
  PupilReflex reflex_{};
};

}  // namespace foci
