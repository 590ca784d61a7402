// The observer's own eye: its optics, its pupil over time, and its state as it is rendered.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "app/session/session_settings.h"
#include "gaze/focus/pupil.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/image/frame.h"
#include "render/optics/defocus.h"
#include "render/optics/lens_field.h"
#include "render/optics/pupil.h"

namespace foci {

/// The observer's lens at a focus.
/// @param focal_px  of the view, px for a tangent of 1
/// @param focus_D   mean over all meridians
Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D);

/// The pupil of the left or the right eye. The wavefront is rescaled to the pupil in use, and its
/// focus is left out: the eye focuses where the wavefront's root mean square is least. With
/// accommodation, coefficient 12 at a pupil of 5 mm changes by `spherical_um_per_D` (Cheng,
/// Barnett, Vilupuru, Marsack, Kasthurirangan, Applegate and Roorda, Journal of Vision 4, 2004).
/// @param focus_D  mean over all meridians; what exceeds the far point is accommodation
Pupil pupilOfEye(const ObserverSettings& observer, bool left, double pupil_mm,
                 const glm::vec2& focal_px, double focus_D);

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

/// The aberrations over the view of each eye. Equal requests get the same object, so that equal
/// frames are known as such.
class ObserverField {
 public:
  /// @param defocus  of the eye; its field is set
  void set(const FieldAberrations& eye, bool left, const View& view, const glm::vec2& gaze_px,
           Defocus& defocus);

 private:
  struct Made {
    FieldAberrations eye;
    View view;  ///< without its pose
    glm::vec2 gaze_px{0.0f}, radius_px_per_D{0.0f};
    bool operator==(const Made&) const = default;
  };
  struct Entry {
    Made made;
    std::shared_ptr<const LensField> field;
  };
  std::array<Entry, 2> eyes_{};  // left, right
};

struct RenderedEye {
  double focus_D = 0.0;
  double rest_D = 0.0;  ///< where focus is on its way to
  double pupil_mm = 0.0;
  std::optional<glm::dvec2> gaze_px;  ///< on the session's screen

  void followPupil(double pupil_mm_now);

  /// Near its rest, focus is taken for at rest.
  /// @param max_change_D  too small to see: `maxUnseenFocusChange_D`
  void followFocus(double focus_D_now, double rest_D_now, double max_change_D);

  void followGaze(const std::optional<glm::dvec2>& gaze_px_now, const Screen& screen);
};

/// How far focus may change before it shows: until blur radii change by a tenth of a pixel for each
/// JND of tolerance, and never more than 1/32 D.
/// @param px_per_D  change of blur radius with focus, along the image's axes
double maxUnseenFocusChange_D(double tolerance, const glm::vec2& px_per_D);

}  // namespace foci
