// The observer's pupil over time, as the study chooses it: fixed, the recording's, or the one that
// the light of the images gives.
#pragma once

#include <optional>

#include "app/study/study.h"
#include "gaze/focus/pupil.h"
#include "render/image/frame.h"

namespace foci {

class ObserverPupil {
 public:
  explicit ObserverPupil(const Study& study);

  /// The study's own diameter from now on.
  void fix(double pupil_mm) { fixed_mm_ = pupil_mm; }

  /// A diameter that the recording tells is held until the next, through blinks and losses.
  void push(const GazeSample& sample);

  /// An image was shown at `time_s`, not before the last; until the next the eye adapts to it.
  void show(double time_s, const Frame& frame);

  /// Whether the first image must be known, in any blur, before there is a diameter.
  bool needsImage() const { return by_light_ && !shown_mm_; }

  /// Millimetres. Not `needsImage`.
  /// @param time_s  not before the last image's
  double at_mm(double time_s);

 private:
  double fixed_mm_;
  bool by_light_, recorded_;
  PupilScene scene_;  // of a white image
  std::optional<double> recorded_mm_{}, shown_mm_{};
  PupilReflex reflex_{};
};

}  // namespace foci
