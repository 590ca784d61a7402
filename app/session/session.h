// The frame loop as a pure function of (scene, samples, study, changes of keys): the eye at each
// frame's time, and what it sees. Replay drives it from files, `foci live` from what happens.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/graphics/image.h"
#include "app/session/frame_renderer.h"
#include "app/session/observer_pupil.h"
#include "app/session/stereo.h"
#include "app/study/inputs.h"
#include "app/study/study.h"
#include "gaze/follow/gaze_follower.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/scene/surface_query.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What is known of a frame besides its image. Points are on the study's screen, px: where the
/// line of sight of the recording, on its own screen, meets it.
struct FrameRecord {
  double time_s = 0.0;  ///< on the recording's clock
  EyeNow eye;
  std::optional<glm::dvec2> gaze_px;      ///< absent in a blink or a loss
  std::optional<glm::dvec2> fixation_px;  ///< held in saccades, blinks and losses
  double pupil_mm = 0.0;
  std::string method;  ///< that drew it
  RenderStats stats;   ///< of all of its views together; 0 ms where it is not rendered in its turn
  bool rendered = true;  ///< false: it would show nothing new, the image of the frame before stays
};

/// A key that takes another value from a frame on.
struct Change {
  double time_s = 0.0;  ///< of the first frame that it holds for
  std::string key;
  std::string toml;  ///< as `setKey` takes it
};

class Session {
 public:
  /// @param cloud     outlives the session
  /// @param screen    that the samples are on
  /// @param start_s   the recording's first sample: where eye.path begins
  Session(const Study& study, const SurfelCloud& cloud, const Screen& screen, double rate_Hz,
          double start_s);

  /// As if it had just been made, at `start_s`, with the study as it is now.
  void restart(double start_s);

  /// From the next frame on. The session is as it was where this throws.
  /// @throws InputError where the key cannot change while a session runs, or not to this
  void change(const std::string& key, const std::string& toml);

  void push(const GazeSample& sample) {
    follower_.push(sample);
    pupil_.push(sample);
  }

  /// The eye at `time_s`: all of the record but what rendering tells. Every sample up to it has
  /// been pushed, none after it.
  FrameRecord look(double time_s);

  /// What the eye of the last `look`, after the last change, sees, to be rendered by `method`.
  /// Where the study's method is `auto`, focus, pupil and gaze hold while they change by less than
  /// shows, so that an eye at rest has an image at rest; with quality.foveated they hold through
  /// saccades and blinks, too. By other methods it is rendered as the record has it.
  RenderRequest jobOf(const std::string& method, const FrameRecord& record) const;

  /// What it will see, should nothing else change, once its focus has come to rest.
  RenderRequest jobAtRest(const std::string& method, const FrameRecord& record) const;

  /// Draws it, and fills method, stats and `rendered` of its record. The same job as the last is
  /// not rendered again, but where another render may bring more: by a method that goes on with the
  /// image before (`isIncremental`), and under a budget of time, until it has been rendered at
  /// leisure.
  /// @param again  another render of the same job would bring nothing, as far as the caller knows
  /// @return until the next render
  const Frame& render(const RenderRequest& job, FrameRecord& record, bool again = false);
  /// As `render`, with the time to prepare what a budget of time needs of an eye that stands.
  const Frame& render(const std::string& method, FrameRecord& record);

  /// Whether the job has been rendered at leisure, and stands ready.
  bool hasAtLeisure(const RenderRequest& job) const { return at_leisure_ && rendered_.job == job; }

  /// Takes an image that was rendered elsewhere, at leisure, for the next render of `job`.
  void adopt(const RenderRequest& job, RenderedFrame&& rendered);

  /// One that renders the session's scene elsewhere.
  FrameRenderer cloneRenderer() const { return renderer_.cloneSharingScene(); }

  /// Where the observer of the record looks, in the image: one point for each view in it.
  std::vector<glm::dvec2> gazePoints_px(const FrameRecord& record) const;

  /// Rings there, as the study's output.marker wants them.
  void mark(const FrameRecord& record, Image& image) const;

  /// With the changes so far.
  const Study& study() const { return study_; }

  const EyePath& path() const { return path_; }

 private:
  /// What method `auto` renders.
  struct Held {
    double focus_D = 0.0, rest_D = 0.0;  ///< where focus is, and where it is on its way to
    double pupil_mm = 0.0;
    std::optional<glm::dvec2> gaze_px;
  };

  void hold(const FrameRecord& record);
  double focusHold_D(const FrameRecord& record) const;
  bool isUnseen(const FrameRecord& record) const;
  RenderRequest jobWith(const std::string& method, const FrameRecord& record, double focus_D,
                        double pupil_mm) const;
  std::vector<EyeView> viewsAt(double time_s) const;
  std::optional<double> surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                        double half_angle_rad) const;
  Quality qualityOf(const FrameRecord& record, const EyeView& eye) const;
  GazeFollower newFollower();

  Study study_;
  Screen gaze_screen_, screen_;
  double rate_Hz_, start_s_;
  EyePath path_;
  SurfaceQuery query_;
  FrameRenderer renderer_;
  GazeFollower follower_;
  ObserverPupil pupil_;
  std::optional<Held> held_;
  RenderedFrame rendered_;   // last
  bool at_leisure_ = false;  // it was, elsewhere
  bool shown_ = false;       // it was given out
  Frame sharp_;              // what an eye sees whose pupil follows the light
};

/// Whether frames of the study are held to a time: `auto` is its method, and there is one to hold.
bool holdsTime(const Study& study);

/// What the study lets method `auto` spend, at full acuity.
Quality requestedQuality(const Study& study);

/// Keys that `Session::change` takes.
bool changesLive(std::string_view key);

/// Whether the marker is broken: the observer does not fixate now.
bool isHeld(const FrameRecord& record);

/// Where a point of one screen, seen from its eye, lies on another seen from its own.
std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px);

}  // namespace foci
