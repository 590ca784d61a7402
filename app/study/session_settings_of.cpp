#include "app/study/session_settings_of.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "app/study/eye_tables.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/methods/method.h"
#include "render/optics/wavefront.h"

namespace foci {
namespace {

/// The observer's eyes, without what glasses correct.
struct Eyes {
  Refraction refraction{};
  std::array<Wavefront, 2> wavefronts{};  ///< left, right
};

/// Without glasses, the second order that both wavefronts have in common, at the pupil
/// `observer.pupil_mm`, is the refraction.
Eyes eyesOf(const Study::Observer& observer) {
  Eyes eyes;
  if (!observer.corrected) {
    eyes.refraction = refractionOf({.sphere_D = observer.sphere_D,
                                    .cylinder_D = observer.cylinder_D,
                                    .axis_deg = observer.axis_deg});
  }
  MeasuredEyes measured;
  if (observer.wavefront.file) {
    measured = readWavefronts(*observer.wavefront.file, observer.wavefront_pupil_mm);
  } else if (!observer.wavefront.zernike_um.empty()) {
    measured.left = measured.right = Wavefront{.zernike_um = observer.wavefront.zernike_um,
                                               .pupil_m = *observer.wavefront_pupil_mm / 1000.0};
  } else if (observer.age_years) {
    measured.left = measured.right = typicalWavefront(*observer.age_years);
  }
  if (!measured.left && !measured.right) return eyes;
  // One eye alone is the one that the view shows (`checkStudy`).
  eyes.wavefronts = {measured.left ? *measured.left : *measured.right,
                     measured.right ? *measured.right : *measured.left};
  if (observer.corrected) {
    for (Wavefront& eye : eyes.wavefronts) eye = withoutRefraction(std::move(eye));
    return eyes;
  }
  // Higher orders that are rescaled to a smaller pupil have a second order there. A prescription
  // holds at every pupil, and only it gives a wavefront of higher orders alone its power.
  const auto hasPower = [](const Wavefront& eye) { return power_D(eye) != glm::dvec3(0.0); };
  const bool is_prescribed = observer.age_years || std::ranges::none_of(eyes.wavefronts, hasPower);
  const auto powerInUse_D = [&](const Wavefront& eye) {
    return power_D(is_prescribed ? eye : rescaled(eye, observer.pupil_mm / 1000.0));
  };
  const std::array powers_D{powerInUse_D(eyes.wavefronts[0]), powerInUse_D(eyes.wavefronts[1])};
  const glm::dvec3 common_D = 0.5 * (powers_D[0] + powers_D[1]);
  for (const std::size_t side : {0, 1}) {
    eyes.wavefronts[side] = withPower(eyes.wavefronts[side], powers_D[side] - common_D);
  }
  eyes.refraction.far_point_D += common_D.x;
  eyes.refraction.astigmatism_D += glm::vec2(common_D.y, common_D.z);
  return eyes;
}

std::optional<FieldAberrations> fieldOf(const FieldChoice& choice) {
  if (choice.file) return readFieldAberrations(*choice.file);
  return choice.typical ? std::optional(typicalField()) : std::nullopt;
}

}  // namespace

EyePose builtinPose(const Study& study) {
  return study.scene.builtin == "plane" ? planeEyePose() : galleryEyePose();
}

EyePath eyePathOf(const Study& study) {
  const std::string file = study.file.string();
  if (study.eye.recorded) return *study.eye.recorded;
  if (!study.eye.path.empty()) return EyePath(study.eye.path, study.eye.up, file);
  EyeKeyframe pose{.up = study.eye.up};
  if (study.eye.position_m) {
    pose.position_m = *study.eye.position_m;
    pose.look_at_m = *study.eye.look_at_m;
  } else if (study.scene.file) {
    throw InputError(file, "eye.position_m: expected for a scene from a file, as is eye.look_at_m");
  } else {
    const EyePose builtin = builtinPose(study);
    pose.position_m = builtin.position_m;
    pose.look_at_m = builtin.target_m;
    pose.up = builtin.up;
  }
  return EyePath({pose}, study.eye.up, file);
}

SessionSettings sessionSettingsOf(const Study& study) {
  const Eyes eyes = eyesOf(study.observer);
  ObserverSettings observer{study.observer};
  observer.refraction = eyes.refraction;
  observer.wavefronts = eyes.wavefronts;
  observer.field = fieldOf(study.observer.field);
  observer.stiles_crawford_center_m = study.observer.stiles_crawford_center_mm / 1000.0;
  observer.pupil_offset_m = study.observer.pupil_offset_mm / 1000.0;
  std::vector<Colour> colours;
  if (study.screen.spectra && study.observer.chromatic) {
    colours = coloursOfSpectra(readSpectra(*study.screen.spectra), study.observer.wavelengths);
  }
  return {.lighting = study.lighting,
          .path = eyePathOf(study),
          .screen = study.screenInForce(),
          .headset = study.display.kind == DisplayKind::headset ? std::optional(study.headsetEyes())
                                                                : std::nullopt,
          .luminance_cd_m2 = study.screen.luminance_cd_m2,
          .colours = std::move(colours),
          .observer = std::move(observer),
          .events = study.gaze.events,
          .focus = study.focus,
          .method = study.render.method,
          .device = study.render.device,
          .quality = study.quality,
          .output = {.size_px = study.imageSize_px(),
                     .stereo = study.output.view,
                     .split = study.output.split,
                     .depth = std::ranges::any_of(
                         study.output.maps, [](FrameMap map) { return map != FrameMap::light; })}};
}

bool ellipsesAsCircles(const Study& study) {
  return eyesOf(study.observer).refraction.astigmatism_D != glm::vec2(0.0f) &&
         !methodInfo(study.render.method).ellipses;
}

std::string eyeRemark(const Study& study) {
  const std::string& method = study.render.method;
  const Study::Observer& observer = study.observer;
  const Eyes eyes = eyesOf(observer);
  std::string remark;
  if (ellipsesAsCircles(study)) {
    remark =
        "method " + method +
        " has one radius of blur: an astigmatic eye's ellipses are circles of the same variance.";
  }
  const bool aberrations = eyes.wavefronts[0] || eyes.wavefronts[1] || observer.stiles_crawford ||
                           observer.diffraction || observer.spherical_um_per_D != 0.0 ||
                           observer.field.typical || observer.field.file;
  if (aberrations && !methodInfo(method).aberrations) {
    remark += (remark.empty() ? "method " : " Method ") + method +
              " leaves out the observer's aberrations, diffraction and the Stiles-Crawford effect; "
              "auto, sweep:N, sweep-lod and accumulate:N render them.";
  }
  return remark;
}

namespace {

/// Those that may name a file.
constexpr std::string_view kWavefrontKey = "observer.wavefront", kFieldKey = "observer.field";

}  // namespace

std::string remoteValue(const Study& study, const std::string& key, const std::string& toml) {
  if (key != kWavefrontKey && key != kFieldKey) return toml;
  Study named = study;
  setKey(named, key, toml, "change");
  const auto& name = key == kFieldKey ? named.observer.field.file : named.observer.wavefront.file;
  if (!name) return toml;
  if (!study.remote.folder) {
    throw InputError(key,
                     "names a file: expected remote.folder in the study, whose files remote "
                     "control may name");
  }
  std::error_code error;
  const auto folder = std::filesystem::canonical(*study.remote.folder, error);
  const auto file = std::filesystem::canonical(folder / *name, error);  // follows links
  const bool inside =
      std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
  if (error || !inside || !std::filesystem::is_regular_file(file, error)) {
    throw InputError(key, "expected the name of a file in remote.folder, " + folder.string());
  }
  return quotedText(file.string());
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
