#include "app/session/observer_pupil.h"

#include <algorithm>
#include <cassert>

#include "render/image/srgb.h"

namespace foci {
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

}  // namespace foci
