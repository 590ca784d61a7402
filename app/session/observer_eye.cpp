#include "app/session/observer_eye.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "gaze/geometry/line_of_sight.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

constexpr double kDiffraction_m = 555e-9, kSphericalPupil_m = 5e-3;

}  // namespace

Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D) {
  Defocus defocus = defocusOfLens(pupil_mm / 1000.0, focal_px, focus_D, DistanceAlong::sight);
  defocus.astigmatism_D = observer.refraction.astigmatism_D;
  return defocus;
}

Pupil pupilOfEye(const ObserverSettings& observer, bool left, double pupil_mm,
                 const glm::vec2& focal_px, double focus_D) {
  // The nose is to the left of the right eye, in the image that it sees.
  const glm::dvec2 from_nasal(left ? 1.0 : -1.0, -1.0);
  Pupil pupil{.diameter_m = pupil_mm / 1000.0};
  if (pupil_mm <= 0.0) return pupil;  // a pinhole
  if (observer.stiles_crawford) {
    pupil.stiles_crawford_per_mm2 = kStilesCrawford_per_mm2;
    pupil.stiles_crawford_center_m = from_nasal * observer.stiles_crawford_center_m;
  }
  pupil.offset_m = from_nasal * observer.pupil_offset_m;
  if (observer.diffraction) {
    pupil.diffraction_px =
        static_cast<float>(diffractionGaussian_rad(pupil.diameter_m, kDiffraction_m) *
                           std::sqrt(focal_px.x * focal_px.y));
  }
  Wavefront measured = observer.wavefronts[left ? 0 : 1];
  const double accommodation_D = std::max(focus_D - observer.refraction.far_point_D, 0.0);
  if (observer.spherical_um_per_D != 0.0 && accommodation_D > 0.0) {
    Wavefront change{.zernike_um = std::vector<double>(13), .pupil_m = kSphericalPupil_m};
    change.zernike_um[12] = observer.spherical_um_per_D * accommodation_D;
    if (measured.pupil_m <= 0.0) measured.pupil_m = kSphericalPupil_m;
    change = rescaled(change, measured.pupil_m);
    measured.zernike_um.resize(std::max<std::size_t>(measured.zernike_um.size(), 13));
    for (std::size_t j = 0; j < 13; ++j) measured.zernike_um[j] += change.zernike_um[j];
  }
  if (!measured) return pupil;
  // The second order, in dioptres, holds at every pupil.
  pupil.wavefront =
      withPower(rescaled(measured, pupil.diameter_m), power_D(observer.wavefronts[left ? 0 : 1]));
  return pupil;
}

namespace {

// Ages of the observers that the formula was fitted to (Watson and Yellott 2012).
constexpr double kMinAge_years = 20.0, kMaxAge_years = 83.0;

}  // namespace

ObserverPupil::ObserverPupil(const SessionSettings& settings)
    : fixed_mm_(settings.observer.pupil_mm),
      by_luminance_(settings.observer.pupil == PupilModel::luminance),
      recorded_(settings.observer.pupil == PupilModel::recording),
      scene_{.luminance_cd_m2 = settings.luminance_cd_m2,
             .area_deg2 = fieldArea_deg2(settings.screen)} {
  const auto& age_years = settings.focus.accommodation.age_years;
  if (age_years) scene_.age_years = std::clamp(*age_years, kMinAge_years, kMaxAge_years);
}

void ObserverPupil::push(const GazeSample& sample) {
  if (recorded_ && sample.pupil_mm && !sample.blink) recorded_mm_ = sample.pupil_mm;
}

void ObserverPupil::show(double time_s, const Frame& frame) {
  if (!by_luminance_) return;
  if (shown_mm_) reflex_.follow(time_s, *shown_mm_);
  PupilScene scene = scene_;
  scene.luminance_cd_m2 *= meanLuminance(frame);
  shown_mm_ = pupilDiameter_mm(scene);
}

double ObserverPupil::at_mm(double time_s) {
  assert(!needsFrame());
  if (by_luminance_) return reflex_.follow(time_s, *shown_mm_);
  return recorded_mm_.value_or(fixed_mm_);
}

namespace {

// The steps were chosen by hand. A test bounds their sum: NoOneSeesThatAFrameIsReused, in
// frame_reuse_test.cpp, allows a quarter of the tolerance. The step of gaze is below the size of
// most microsaccades, and changes the finest visible angle (acuity.h) by less than half of its
// value at the gaze: 0.0275 / 3 deg against 1/48 deg.
constexpr double kBlurStep_px = 0.1, kMaxFocusStep_D = 1.0 / 32.0, kPupilStep_mm = 1.0 / 16.0;
constexpr double kGazeStep_deg = 1.0 / 3.0;

double step(double now, double before, double max_change) {
  return std::abs(now - before) <= max_change ? before : now;
}

}  // namespace

void ObserverField::set(const FieldAberrations& eye, bool left, const View& view,
                        const glm::vec2& gaze_px, Defocus& defocus) {
  Made wanted{eye, view, gaze_px, defocus.radius_px_per_D};
  wanted.view.eye_from_world = glm::mat4(1.0f);
  Entry& entry = eyes_[left ? 0 : 1];
  if (!entry.field || !(entry.made == wanted)) {
    entry.field = std::make_shared<const LensField>(eye, left, view, gaze_px, defocus);
    entry.made = wanted;
  }
  defocus.field = entry.field;
}

void RenderedEye::followPupil(double pupil_mm_now) {
  pupil_mm = step(pupil_mm_now, pupil_mm, kPupilStep_mm);
}

void RenderedEye::followFocus(double focus_D_now, double rest_D_now, double max_change_D) {
  rest_D = step(rest_D_now, rest_D, max_change_D);
  focus_D = std::abs(focus_D_now - rest_D) <= max_change_D
                ? rest_D
                : step(focus_D_now, focus_D, max_change_D);
}

void RenderedEye::followGaze(const std::optional<glm::dvec2>& gaze_px_now, const Screen& screen) {
  const bool near =
      gaze_px_now && gaze_px && angleBetween_deg(screen, *gaze_px_now, *gaze_px) <= kGazeStep_deg;
  if (!near) gaze_px = gaze_px_now;
}

double maxUnseenFocusChange_D(double tolerance, const glm::vec2& px_per_D) {
  return std::min(kMaxFocusStep_D, kBlurStep_px * tolerance / std::max(px_per_D.x, px_per_D.y));
}

}  // namespace foci
