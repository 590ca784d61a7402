#include "app/session/observer_pupil.h"

#include <algorithm>
#include <cassert>

#include "render/image/srgb.h"

namespace foci {
namespace {

// Of the ages that the formula was made from.
constexpr double kYoungest_years = 20.0, kOldest_years = 83.0;

}  // namespace

ObserverPupil::ObserverPupil(const Study& study)
    : fixed_mm_(study.observer.pupil_mm),
      by_light_(study.observer.pupil == "luminance"),
      recorded_(study.observer.pupil == "recording"),
      scene_{.luminance_cd_m2 = study.screen.luminance_cd_m2,
             .area_deg2 = fieldArea_deg2(study.screenInForce())} {
  const auto& age = study.focus.accommodation.age_years;
  if (age) scene_.age_years = std::clamp(*age, kYoungest_years, kOldest_years);
}

void ObserverPupil::push(const GazeSample& sample) {
  if (recorded_ && sample.pupil_mm && !sample.blink) recorded_mm_ = sample.pupil_mm;
}

void ObserverPupil::show(double time_s, const Frame& frame) {
  if (!by_light_) return;
  if (shown_mm_) reflex_.follow(time_s, *shown_mm_);
  PupilScene scene = scene_;
  scene.luminance_cd_m2 *= meanLuminance(frame);
  shown_mm_ = pupilDiameter_mm(scene);
}

double ObserverPupil::at_mm(double time_s) {
  assert(!needsImage());
  if (by_light_) return reflex_.follow(time_s, *shown_mm_);
  return recorded_mm_.value_or(fixed_mm_);
}

}  // namespace foci
