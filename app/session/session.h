// From gaze samples and a scene to eye states and frames: a pure function of scene, samples and
// settings. `foci replay` feeds it from files, `foci live` from a tracker, `foci render` asks for a
// single frame.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/session/frame_record.h"
#include "app/session/frame_renderer.h"
#include "app/session/observer_eye.h"
#include "app/session/session_settings.h"
#include "gaze/follow/gaze_follower.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/image/frame.h"
#include "render/lod/surface_query.h"
#include "render/methods/method.h"
#include "render/scene/scene.h"

namespace foci {

class Session {
 public:
  /// @param scene        outlives the session
  /// @param gaze_screen  that the samples are on
  /// @param rate_Hz      of the samples, nominal
  /// @param start_s      time of the first sample: the path of the eye begins there
  /// @param window_gpu   of the window that shows the frames; preferred to other GPUs, because its
  ///                     frames can stay on it. Null: there is none
  /// @throws InputError where the method is unknown, or an image cannot be halved for two eyes
  Session(const SessionSettings& settings, const Scene& scene, const Screen& gaze_screen,
          double rate_Hz, double start_s, const SharedGpu& window_gpu = nullptr);

  /// As if it had just been made, at `start_s`, with the settings as they are now.
  void restart(double start_s);

  /// New settings from the next frame on. Screen, source of the pupil, and what the gaze follower
  /// knows (events, accommodation, cone, vergence) change at the next `restart` only.
  /// @throws InputError as the constructor; the session is then as it was
  void changeSettings(const SessionSettings& settings);

  void push(const GazeSample& sample) {
    follower_.push(sample);
    pupil_.push(sample);
  }

  /// The eye at `time_s`: the record without what rendering adds. Every sample up to `time_s` has
  /// been pushed, and none after it.
  FrameRecord look(double time_s);

  /// The same for a reader of states, between frames and at any rate. While the eye and gaze rest,
  /// the surface of the last question holds (`AskSurface::whenMoved`). Frames do not follow it.
  FrameRecord state(double time_s);

  /// The eye after a long fixation of a point, without samples: focus has come to rest.
  /// @param point_px  on the session's screen
  FrameRecord lookSettled(double time_s, const glm::dvec2& point_px);

  /// Where an eye looks that nobody directs: at the middle of the screen, or, with no surface
  /// there, at the nearest surface on the smallest ring around it that meets one. Absent: on none.
  std::optional<glm::dvec2> middleSurface_px(double time_s) const;

  /// The surface that a point of the screen shows, in the world; absent: none.
  std::optional<glm::dvec3> surfaceUnder_m(double time_s, const glm::dvec2& point_px) const;

  /// What the eye of the last `look` or `lookSettled` sees, to be rendered by `method`. If the
  /// session's method chooses its quality (`auto`), focus, pupil and gaze change in steps too small
  /// to see, so that an eye at rest has equal requests. With foveation nothing changes in saccades
  /// and blinks, either. Other methods render the record as it is.
  RenderRequest requestOf(const std::string& method, const FrameRecord& record) const;

  /// What the eye will see once its focus has come to rest, should nothing else change.
  RenderRequest requestAtRest(const std::string& method, const FrameRecord& record) const;

  /// Renders a request, and fills method, stats and `rendered` of its record. Reuses the previous
  /// frame if the request is the same and rendering it again would bring nothing new. It may do so
  /// for a method that goes on with the frame before (`MethodInfo::incremental`), and under a
  /// frame-time budget until the frame has full quality.
  /// @param again_is_useless  as far as the caller knows
  /// @return until the next call
  const Frame& render(const RenderRequest& request, FrameRecord& record,
                      bool again_is_useless = false);
  /// The same, but what the GPU renders may stay there (`RenderedFrame::on_gpu`).
  RenderedFrame& renderKept(const RenderRequest& request, FrameRecord& record,
                            bool again_is_useless = false);
  /// Renders `requestOf`, and takes the time to prepare for a frame-time budget while the eye
  /// does not move.
  const Frame& render(const std::string& method, FrameRecord& record);
  RenderedFrame& renderKept(const std::string& method, FrameRecord& record);

  /// Passes over a frame: the next frames are as if this one had been rendered. `record` gets no
  /// method and no stats. Renders if the pupil follows luminance. Not for a method that goes on
  /// with the frame before (`MethodInfo::incremental`), nor under a frame-time budget.
  void pass(const std::string& method, FrameRecord& record);

  /// Whether a frame of the request at full quality has been adopted.
  bool hasFullQuality(const RenderRequest& request) const {
    return full_quality_ && last_.request == request;
  }

  /// Takes a frame that was rendered elsewhere, at full quality, for the next render of `request`,
  /// and gives the last one for it.
  void adopt(const RenderRequest& request, RenderedFrame& rendered);

  /// A renderer of the session's scene, for another thread.
  FrameRenderer cloneRenderer() const { return renderer_.cloneSharingScene(); }
  /// The session's own: it reads frames from the GPU.
  FrameRenderer& renderer() { return renderer_; }

  /// Where the observer looks in the image: a point for each view in it.
  std::vector<glm::dvec2> gazePoints_px(const FrameRecord& record) const;

  /// Where the image shows lines, in each view: two ends each. Lines that leave the view are
  /// absent.
  std::vector<glm::dvec2> linesInImage_px(double time_s, std::span<const glm::vec3> ends_m) const;

  /// Whether a view of that time has any of the points in its image.
  bool isInView(double time_s, std::span<const glm::vec3> points_m) const;

  const SessionSettings& settings() const { return settings_; }

  /// What renders a method, for people (`FrameRenderer::deviceOf`).
  std::string deviceOf(const std::string& method) const { return renderer_.deviceOf(method); }

  /// What rendered the frames since the session began, in order of first use: "A, then B". Before
  /// the first frame: what will render it.
  std::string devices() const;

  /// Why the CPU renders where the GPU was to; empty: it does not. Changes when the GPU fails.
  std::string deviceRemark() const;

 private:
  FrameRecord recordAt(double time_s, AskSurface ask);
  void finishLook(FrameRecord& record);
  void showSharpFrame(double time_s);
  void noteDevice();
  void followEye(const FrameRecord& record);
  bool isUnseen(const FrameRecord& record) const;
  RenderRequest requestWith(const std::string& method, const FrameRecord& record, double focus_D,
                            double pupil_mm) const;
  std::optional<glm::dvec2> onScreen_px(const glm::dvec2& point_px, double then_s,
                                        double now_s) const;
  View middleViewAt(double time_s) const;
  std::vector<EyeView> viewsAt(double time_s) const;
  std::optional<double> surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                        double half_angle_rad) const;
  std::optional<double> distanceUnder_m(double time_s, const glm::dvec2& point_px) const;
  Quality qualityOf(const FrameRecord& record, const EyeView& eye) const;
  glm::vec2 inView_px(const glm::dvec2& point_px, const EyeView& eye) const;
  void addField(const FrameRecord& record, const EyeView& eye, Defocus& defocus) const;
  GazeFollower newFollower();

  SessionSettings settings_;
  Screen gaze_screen_;
  double rate_Hz_, start_s_;
  SurfaceQuery query_;
  FrameRenderer renderer_;
  GazeFollower follower_;
  ObserverPupil pupil_;
  std::optional<RenderedEye> rendered_eye_;
  std::optional<glm::dvec2> last_gaze_px_;  // on the session's screen
  mutable ObserverField field_;             // what the last requests had
  RenderedFrame last_;
  std::vector<std::string> devices_;  // that rendered frames, each once
  bool full_quality_ = false;         // of the last frame, which was adopted
  bool returned_ = false;             // the last frame was, by `render`
  bool passed_ = false;               // the last request was: it has no frame yet
  Frame sharp_;                       // what an eye sees whose pupil follows luminance
};

/// Where a point of one screen, seen from its eye, lies on another screen seen from its own.
std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px);

}  // namespace foci
