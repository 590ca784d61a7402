// What a session shows, to whom, on which screen and how well.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/session/eye_path.h"
#include "app/session/stereo.h"
#include "gaze/events/event_settings.h"
#include "gaze/focus/accommodation.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/optics/colours.h"
#include "render/optics/eye_field.h"
#include "render/optics/view.h"
#include "render/optics/wavefront.h"

namespace foci {

/// Where the diameter of the pupil comes from: a fixed number, the gaze samples, or the luminance
/// of the rendered frames.
enum class PupilModel { fixed, recording, luminance };

/// The observer, as far as a study states it in the terms of the session.
struct StatedObserver {
  PupilModel pupil = PupilModel::fixed;
  double pupil_mm = 4.0;  ///< where fixed, and until a recording says one
  double ipd_mm = 63.0;
  bool chromatic = false;  ///< red, green and blue each have their focus (colours.h)
  /// Change of coefficient 12 with accommodation (observer_eye.h).
  double spherical_um_per_D = 0.0;
  bool stiles_crawford = false;
  bool diffraction = false;
};

struct ObserverSettings : StatedObserver {
  Refraction refraction{};  ///< what glasses do not correct; default: none
  /// Of the left and the right eye, as measured; what `refraction` holds is left out.
  std::array<Wavefront, 2> wavefronts{};
  std::optional<FieldAberrations> field{};   ///< aberrations beside the line of sight
  glm::dvec2 stiles_crawford_center_m{0.0};  ///< towards the nose, upwards
  glm::dvec2 pupil_offset_m{0.0};  ///< from the achromatic axis: towards the nose, upwards
};

struct FocusSettings {
  double cone_deg = 0.5;  ///< half-angle of the cone in which the surface is sought
  double coverage = 0.5;  ///< share of the cone that a surface must fill
  /// The far point comes from the observer's refraction.
  AccommodationSettings accommodation{};
  bool vergence = false;            ///< the distance at which both lines of sight meet counts, too
  std::optional<double> fixed_D{};  ///< focus stays there, whatever the eye looks at
};

/// What method `auto` may spend; other methods ignore it.
struct QualitySettings {
  double tolerance = 1.0;            ///< just-noticeable differences
  std::optional<double> frame_ms{};  ///< frame-time budget; absent: none
  bool foveated = false;             ///< no finer than the eye resolves away from the gaze
};

/// What shows the frames: a screen at rest, or one that moves with the head.
enum class DisplayKind { screen, headset };

/// What renders the frames.
enum class RenderDevice {
  automatic,  ///< a GPU, unless OpenGL is missing, older than 4.5, or in software
  gpu,        ///< OpenGL 4.5, in software too
  cpu,
};

/// The image that a frame is rendered to.
struct OutputView {
  glm::ivec2 size_px{1920, 1080};
  StereoView stereo = StereoView::mono;
  bool split = false;  ///< the left half of each view without blur
  bool depth = false;  ///< frames have distances, too; of one view only
};

struct SessionSettings {
  Lighting lighting{};
  EyePath path{};
  Screen screen = defaultScreen();  ///< that the frames are shown on
  /// The displays of a headset. `screen` is then what both eyes see of them.
  std::optional<HeadsetEyes> headset{};
  double luminance_cd_m2 = 120.0;  ///< of the screen's white
  /// Of the screen's light, where `ObserverSettings::chromatic`; empty: its primaries.
  std::vector<Colour> colours{};
  ObserverSettings observer{};
  EventSettings events{};
  FocusSettings focus{};
  std::string method = "auto";  ///< as `makeMethod` takes it
  RenderDevice device = RenderDevice::automatic;
  QualitySettings quality{};
  OutputView output{};
};

/// How the observer's eye accommodates: from the far point that its refraction leaves it.
inline AccommodationSettings accommodationOf(const SessionSettings& settings) {
  AccommodationSettings accommodation = settings.focus.accommodation;
  accommodation.far_point_D = settings.observer.refraction.far_point_D;
  return accommodation;
}

}  // namespace foci
