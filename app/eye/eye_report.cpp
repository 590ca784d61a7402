#include "app/eye/eye_report.h"

#include <algorithm>
#include <cmath>

#include "app/platform/progress.h"
#include "app/session/observer_eye.h"
#include "app/study/session_settings_of.h"
#include "base/parallel.h"

namespace foci {
namespace {

/// A PSF's window: twice the blur's diameter, at least this many arcmin.
constexpr double kLeastWindow_arcmin = 12.0, kMostWindow_arcmin = 240.0;
constexpr int kSamples = 161;

/// The eye's pupil with the refraction that glasses do not correct.
Pupil pupilWithRefraction(const ObserverSettings& observer, bool left, double focus_D) {
  Pupil pupil = pupilOfEye(observer, left, observer.pupil_mm, glm::vec2(1.0f), focus_D);
  pupil.diffraction_px = 0.0f;  // Fourier optics has its own
  const glm::vec2 j = observer.refraction.astigmatism_D;
  if (j == glm::vec2(0.0f)) return pupil;
  pupil.wavefront.pupil_m = pupil.diameter_m;
  pupil.wavefront =
      withPower(pupil.wavefront, power_D(pupil.wavefront) + glm::dvec3(0.0, j.x, j.y));
  return pupil;
}

double windowOf_rad(const EyeOptics& eye) {
  const double reach_rad = std::max(2.0 * eye.wavelength_m / eye.pupil.diameter_m,
                                    steepest_rad(eye, 48, {0.5, 0.8, 1.0}));
  return std::clamp(2.4 * reach_rad, kLeastWindow_arcmin * kArcmin_rad,
                    kMostWindow_arcmin * kArcmin_rad);
}

std::vector<PointImage> pointsOf(const EyeOptics& eye, double focus_D,
                                 const std::vector<double>& vergences_D, double window_rad) {
  std::vector<PointImage> points(vergences_D.size());
  parallelFor(points.size(), [&](std::size_t i) {
    EyeOptics optics = eye;
    optics.defocus_D = focus_D - vergences_D[i];
    points[i] = {.vergence_D = vergences_D[i],
                 .strehl = strehlRatio(optics),
                 .psf = fourierPsf(optics, window_rad / kSamples, kSamples)};
  });
  return points;
}

/// A window for all points, so that their sizes compare.
double windowOfAll_rad(const std::vector<EyeOptics>& eyes, double focus_D,
                       const std::vector<double>& vergences_D) {
  double window_rad = 0.0;
  for (EyeOptics eye : eyes) {
    for (const double vergence_D : vergences_D) {
      eye.defocus_D = focus_D - vergence_D;
      window_rad = std::max(window_rad, windowOf_rad(eye));
    }
  }
  return window_rad;
}

/// The study's eye with what the schematic eye adds beside the line of sight.
std::vector<FieldFigures> fieldsOf(const EyeFigures& eye, const std::vector<double>& vergences_D,
                                   const std::vector<double>& fields_deg) {
  std::vector<FieldFigures> fields;
  std::vector<EyeOptics> optics;
  for (const double field_deg : fields_deg) {
    const auto [added, pupil_aspect] = fieldOfEye(field_deg, eye.pupil.diameter_m);
    EyeOptics beside{.pupil = eye.pupil, .pupil_aspect = pupil_aspect};
    std::vector<double>& um = beside.pupil.wavefront.zernike_um;
    um.resize(std::max(um.size(), added.zernike_um.size()));
    for (std::size_t j = 0; j < added.zernike_um.size(); ++j) um[j] += added.zernike_um[j];
    beside.pupil.wavefront.pupil_m = eye.pupil.diameter_m;
    fields.push_back(
        {.field_deg = field_deg, .aspect = beside.pupil_aspect, .power_D = power_D(added)});
    optics.push_back(std::move(beside));
  }
  const double window_rad = windowOfAll_rad(optics, eye.focus_D, vergences_D);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    fields[i].points = pointsOf(optics[i], eye.focus_D, vergences_D, window_rad);
    fields[i].white_mtf = whiteMtf(optics[i], eye.cycles_per_deg);
    fields[i].green_mtf = radialMtf(optics[i], eye.cycles_per_deg);
  }
  return fields;
}

EyeFigures figuresOf(std::string name, const Pupil& pupil, double focus_D,
                     const EyeRequest& request) {
  EyeFigures eye{.name = std::move(name), .pupil = pupil, .focus_D = focus_D};
  std::vector<double> vergences_D = request.distances_D;
  if (vergences_D.empty()) {
    for (const double off_D : {-1.0, -0.5, 0.0, 0.5, 1.0}) vergences_D.push_back(focus_D + off_D);
  }
  eye.points = pointsOf({.pupil = pupil}, focus_D, vergences_D,
                        windowOfAll_rad({{.pupil = pupil}}, focus_D, vergences_D));
  for (int u = 0; u <= 60; u += 2) eye.cycles_per_deg.push_back(u);
  eye.white_mtf = whiteMtf({.pupil = pupil}, eye.cycles_per_deg);
  eye.green_mtf = radialMtf({.pupil = pupil}, eye.cycles_per_deg);
  const double reach_D = focusReach_D(pupil.diameter_m);
  eye.through = throughFocus(pupil, reach_D, reach_D / 16.0);
  eye.depth = depthOfFocus(eye.through);
  eye.acuity = acuityOf({.pupil = pupil});
  eye.fields = fieldsOf(eye, vergences_D, request.fields_deg);
  return eye;
}

}  // namespace

std::vector<EyeFigures> eyeFiguresOf(const Study& study, const EyeRequest& request) {
  const SessionSettings settings = sessionSettingsOf(study);
  const AccommodationSettings accommodation = accommodationOf(settings);
  const double target_D =
      request.focus_D.value_or(settings.focus.fixed_D.value_or(1.0 / settings.screen.distance_m));
  const double focus_D = reachableFocus_D(accommodation, target_D);
  const Pupil left = pupilWithRefraction(settings.observer, true, focus_D);
  const Pupil right = pupilWithRefraction(settings.observer, false, focus_D);
  // The side of the nose does not matter to a single eye: compare what aberrates.
  const bool equal = left.wavefront == right.wavefront &&
                     left.stiles_crawford_center_m == right.stiles_crawford_center_m;
  Progress progress("computing", "eyes", equal ? 1 : 2);
  std::vector<EyeFigures> eyes;
  if (equal) {
    eyes.push_back(figuresOf("both eyes", right, focus_D, request));
  } else {
    eyes.push_back(figuresOf("left eye", left, focus_D, request));
    progress.advance(1);
    eyes.push_back(figuresOf("right eye", right, focus_D, request));
  }
  progress.advance(eyes.size());
  return eyes;
}

}  // namespace foci
