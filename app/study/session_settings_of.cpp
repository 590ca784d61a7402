#include "app/study/session_settings_of.h"

#include "app/study/inputs.h"
#include "base/input_error.h"
#include "render/methods/method.h"

namespace foci {
namespace {

/// What the prescription leaves uncorrected: nothing if it is worn.
Refraction refractionInForce(const Study::Observer& observer) {
  if (observer.corrected) return {};
  return refractionOf({.sphere_D = observer.sphere_D,
                       .cylinder_D = observer.cylinder_D,
                       .axis_deg = observer.axis_deg});
}

}  // namespace

EyePath eyePathOf(const Study& study) {
  const std::string file = study.file.string();
  if (study.eye.recorded) return *study.eye.recorded;
  if (!study.eye.path.empty()) return EyePath(study.eye.path, study.eye.up, file);
  EyeKeyframe pose{.up = study.eye.up};
  if (study.eye.position_m) {
    pose.position_m = *study.eye.position_m;
    pose.look_at_m = *study.eye.look_at_m;
  } else if (study.scene.file) {
    throw InputError(file,
                     "eye.position_m: expected for a scene from a file, as is eye.look_at_m; a "
                     "recording's head moves the eye in foci replay only");
  } else {
    const EyePose builtin = builtinPose(study);
    pose.position_m = builtin.position_m;
    pose.look_at_m = builtin.target_m;
    pose.up = builtin.up;
  }
  return EyePath({pose}, study.eye.up, file);
}

SessionSettings sessionSettingsOf(const Study& study) {
  return {.background = glm::vec3(study.scene.background),
          .shading = static_cast<float>(study.render.shading),
          .path = eyePathOf(study),
          .screen = study.screenInForce(),
          .headset = study.display.kind == DisplayKind::headset
                         ? std::optional(study.display.field())
                         : std::nullopt,
          .luminance_cd_m2 = study.screen.luminance_cd_m2,
          .observer = {.pupil = study.observer.pupil,
                       .pupil_mm = study.observer.pupil_mm,
                       .ipd_mm = study.observer.ipd_mm,
                       .refraction = refractionInForce(study.observer),
                       .chromatic = study.observer.chromatic},
          .events = study.gaze.events,
          .focus = {.cone_half_angle_deg = study.focus.cone_deg,
                    .coverage = study.focus.coverage,
                    .accommodation = study.focus.accommodation,
                    .vergence = study.focus.vergence,
                    .fixed_D = study.focus.fixed_D},
          .method = study.render.method,
          .device = study.render.device,
          .quality = study.quality,
          .output = {.size_px = study.imageSize_px(),
                     .stereo = study.output.view,
                     .split = study.output.split,
                     .depth = !study.output.maps.empty()}};
}

std::string ellipseRemark(const Study& study) {
  const std::string& method = study.render.method;
  const Refraction refraction = refractionInForce(study.observer);
  if (refraction.astigmatism_D == glm::vec2(0.0f) || rendersEllipses(method)) return {};
  return "method " + method +
         " has one radius of blur: an astigmatic eye's ellipses are circles of the same variance.";
}

}  // namespace foci
