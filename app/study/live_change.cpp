#include "app/study/live_change.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "app/study/session_settings_of.h"
#include "base/input_error.h"

namespace foci {
namespace {

constexpr std::string_view kLiveKeys[] = {
    "eye.position_m",
    "eye.look_at_m",
    "observer.pupil_mm",
    "observer.ipd_mm",
    "focus.fixed_D",
    "render.method",
    "render.shading",
    "scene.background",
    "output.marker",
    "output.split",
    "output.view",
    "quality.tolerance",
    "quality.frame_ms",
    "quality.foveated",
    "observer.sphere_D",
    "observer.cylinder_D",
    "observer.axis_deg",
    "observer.corrected",
    "observer.chromatic",
    "observer.wavefront",
    "observer.wavefront_pupil_mm",
    "observer.age_years",
    "observer.spherical_um_per_D",
    "observer.stiles_crawford",
    "observer.stiles_crawford_center_mm",
    "observer.pupil_offset_mm",
    "observer.diffraction",
};

}  // namespace

bool changesLive(std::string_view key) {
  return std::find(std::begin(kLiveKeys), std::end(kLiveKeys), key) != std::end(kLiveKeys);
}

void changeLive(Study& study, Session& session, const std::string& key, const std::string& toml) {
  Study changed = study;
  setKey(changed, key, changesLive(key) ? toml : "null", "change");  // refuses an unknown key
  if (!changesLive(key)) throw InputError(key, "does not change while foci runs");
  checkStudy(changed);
  session.changeSettings(sessionSettingsOf(changed));
  study = std::move(changed);
}

}  // namespace foci
