// The frame loop as a pure function of (scene, trace, study): the eye at each frame's time, and
// what it sees. Replay drives it from a file; whatever else drives it brings its own samples and
// times.
#pragma once

#include <memory>
#include <optional>

#include "app/inputs.h"
#include "app/observer_pupil.h"
#include "app/study.h"
#include "gaze/focus/gaze_follower.h"
#include "gaze/gaze.h"
#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/scene/surface_query.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What is known of a frame besides its picture. Points are on the study's screen, px: where the
/// line of sight of the recording, on its own screen, meets it.
struct FrameRecord {
  double time_s = 0.0;  ///< on the recording's clock
  EyeNow eye;
  std::optional<glm::dvec2> gaze_px;      ///< absent in a blink or a loss
  std::optional<glm::dvec2> fixation_px;  ///< held in saccades, blinks and losses
  double pupil_mm = 0.0;
  RenderStats stats;
};

class Session {
 public:
  /// @param cloud     outlives the session
  /// @param screen    that the samples are on
  /// @param start_s   the recording's first sample: where eye.path begins
  Session(const Study& study, const SurfelCloud& cloud, const Screen& screen, double rate_Hz,
          double start_s);

  void push(const GazeSample& sample) {
    follower_.push(sample);
    pupil_.push(sample);
  }

  /// Draws what the eye sees at `time_s`. Every sample up to it has been pushed, none after it.
  FrameRecord render(double time_s, Frame& frame);

  /// The view of the last frame without blur.
  void renderSharp(Frame& frame);

  /// A point of the study's screen on the pictures, px.
  glm::dvec2 pictureFromScreen_px(const glm::dvec2& point_px) const;

 private:
  View viewAt(double time_s) const;
  std::optional<double> surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                        double half_angle_rad) const;

  const Study& study_;
  Screen gaze_screen_, screen_;
  double start_s_;
  EyePath path_;
  SurfaceQuery query_;
  std::unique_ptr<Method> method_;
  GazeFollower follower_;
  ObserverPupil pupil_;
  double last_s_ = 0.0;
};

/// Where a point of one screen, seen from its eye, lies on another seen from its own.
std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px);

}  // namespace foci
