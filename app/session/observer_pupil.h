// The diameter of the observer's pupil over time: fixed, from the recording, or from the luminance
// of the rendered frames.
#pragma once

#include <optional>

#include "app/session/session_settings.h"
#include "gaze/focus/pupil.h"
#include "render/image/frame.h"

namespace foci {

class ObserverPupil {
 public:
  explicit ObserverPupil(const SessionSettings& settings);

  /// Sets the fixed diameter from now on.
  void fix(double pupil_mm) { fixed_mm_ = pupil_mm; }

  /// A recorded diameter stays until the next one, through blinks and data loss.
  void push(const GazeSample& sample);

  /// Whether the pupil depends on the frames that are shown.
  bool followsFrames() const { return by_luminance_; }

  /// A frame was shown at `time_s`, not before the last one. The pupil adapts to it until the next.
  void show(double time_s, const Frame& frame);

  /// Whether a first frame, sharp or blurred, must be shown before there is a diameter.
  bool needsFrame() const { return by_luminance_ && !shown_mm_; }

  /// Millimetres. Not while `needsFrame` (asserted).
  /// @param time_s  not before the last frame's
  double at_mm(double time_s);

 private:
  double fixed_mm_;
  bool by_luminance_, recorded_;
  PupilScene scene_;  // of a white frame
  std::optional<double> recorded_mm_{}, shown_mm_{};
  PupilReflex reflex_{};
};

}  // namespace foci
