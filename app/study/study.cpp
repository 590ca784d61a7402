// Reads the file of a study, and checks what several keys decide together.

#include "app/study/study.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/study/eye_tables.h"
#include "app/study/gaze_calibration.h"
#include "app/study/inputs.h"
#include "app/study/toml_values.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/camera/camera.h"
#include "calibration/screen/screen_file.h"
#include "calibration/toml_file.h"

namespace foci {
namespace {

/// Keys of which a study has only one.
constexpr std::pair<const char*, const char*> kExclusive[] = {
    {"scene.file", "scene.builtin"},     {"screen.monitor", "screen.size_px"},
    {"screen.monitor", "screen.size_m"}, {"screen.monitor", "screen.distance_m"},
    {"screen.monitor", "screen.gamma"},  {"observer.wavefront", "observer.age_years"},
    {"eye.path", "eye.position_m"},      {"eye.path", "eye.look_at_m"},
};

void resolve(std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.is_relative()) path = (folder / path).lexically_normal();
}

/// Replaces the screen by the calibrated one, if the study names one.
void takeMonitor(Study& study) {
  if (!study.screen.monitor) return;
  const ScreenCalibration calibration = readScreen(*study.screen.monitor);
  static_cast<Screen&>(study.screen) = calibration.screen;
  study.screen.gamma = calibration.gamma;
  study.screen.is_default = false;
}

[[noreturn]] void refuse(const Study& study, const std::string& what) {
  throw InputError(study.file.string(), what);
}

void checkAlignment(const Study& study) {
  if (!(glm::length(study.gaze.alignment.rotation) > 1e-3)) {
    refuse(study, "gaze.scene_rotation: expected a quaternion x, y, z, w that is not 0");
  }
}

}  // namespace

bool decidesAngles(std::string_view key) {
  return key.starts_with("screen.") && key != "screen.gamma" && key != "screen.luminance_cd_m2";
}

Study readStudy(const std::filesystem::path& file) {
  const TomlDocument document = readToml(file);
  Study study;
  study.file = file;
  const auto given = setKeys(study, document, file.string());

  for (const auto& [one, other] : kExclusive) {
    if (given.contains(one) && given.contains(other)) {
      throw InputError(file.string(),
                       std::string(one) + " and " + other + ": expected only one of them");
    }
  }

  const std::filesystem::path folder = file.parent_path();
  for (auto* path : {&study.scene.file, &study.screen.monitor, &study.observer.wavefront.file,
                     &study.observer.field.file, &study.screen.spectra, &study.gaze.map,
                     &study.gaze.camera, &study.record.frames, &study.record.changes,
                     &study.record.markers, &study.record.head, &study.remote.folder}) {
    if (*path) resolve(**path, folder);
  }
  for (ScenePart& part : study.scene.parts) resolve(part.file, folder);
  if (auto place = webcamPlaceOf(study.gaze.source)) {
    if (!place->device) {
      resolve(place->file, folder);
      study.gaze.source = "webcam:" + place->file.string();
    }
  } else if (!study.gazeIsSimulated()) {
    std::filesystem::path trace = study.gaze.source;
    resolve(trace, folder);
    study.gaze.source = trace.string();
  }
  study.screen.is_default = std::ranges::none_of(given, decidesAngles);
  checkAlignment(study);
  takeMonitor(study);
  return study;
}

void overrideKey(Study& study, std::string_view key, const OptionValue& value,
                 const std::string& option) {
  const toml::value toml = std::visit(
      [](const auto& v) -> toml::value {
        // An integer key wants integers; a real key takes them, too.
        const auto number = [](double d) -> toml::value {
          if (std::abs(d) < 1e15 && d == std::floor(d)) return static_cast<std::int64_t>(d);
          return d;
        };
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>) {
          return number(v);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) {
          return toml::value(v);
        } else {
          toml::array array;
          for (const double element : v) array.push_back(number(element));
          return array;
        }
      },
      value);
  try {
    setKey(study, key, toml);
  } catch (const Expected& expected) {
    throw InputError(option, "expected " + expected.what);
  }
  if (key == "screen.monitor") takeMonitor(study);
}

namespace {

void checkGaze(const Study& study) {
  if (study.gaze.map && study.gazeIsSimulated()) {
    refuse(study, "gaze.map: expected a recording to map, not simulated gaze");
  }
  const bool webcam = webcamPlaceOf(study.gaze.source).has_value();
  if (webcam && !study.gaze.map) {
    refuse(
        study,
        "gaze.source: a webcam needs gaze.map (--gaze-map): foci calibrate gaze --source webcam");
  }
  if (study.gaze.map) readGazeCalibration(*study.gaze.map, webcam);
  const TraceColumns& columns = study.gaze.columns;
  if (columns.rate_Hz && !columns.time.empty()) {
    refuse(study, "gaze.rate_Hz and gaze.time: expected only one of them");
  }
  for (std::size_t side : {0, 1}) {
    if (columns.eyes[side].x.empty() != columns.eyes[side].y.empty()) {
      refuse(study, side == 0 ? "gaze.left_x and gaze.left_y: expected both or neither"
                              : "gaze.right_x and gaze.right_y: expected both or neither");
    }
  }
  if (study.gaze.camera) readCamera(*study.gaze.camera);
  checkAlignment(study);
  if (study.gaze.map && recordsHead(study)) {
    refuse(study, "gaze.map: expected a recording on a screen, not one with head poses");
  }
}

/// @param name  of the pose, for messages
void checkPose(const Study& study, const EyeKeyframe& pose, const std::string& name) {
  const glm::dvec3 sight = pose.look_at_m - pose.position_m;
  const glm::dvec3 up = pose.up.value_or(study.eye.up);
  if (!(glm::length(sight) > 1e-6)) {
    refuse(study, name + ": expected look_at_m away from position_m");
  }
  if (!(glm::length(up) > 1e-6) ||
      !(glm::length(glm::cross(glm::normalize(sight), glm::normalize(up))) > 1e-4)) {
    refuse(study, name + ": expected up not along the line of sight");
  }
}

void checkEye(const Study& study) {
  const Study::Eye& eye = study.eye;
  if (recordsHead(study)) {
    if (eye.position_m || !eye.path.empty()) {
      refuse(study, std::string(eye.path.empty() ? "eye.position_m" : "eye.path") +
                        ": the head of the recording moves the eye; expected only one of them");
    }
    return;
  }
  if (eye.position_m.has_value() != eye.look_at_m.has_value()) {
    refuse(study, "eye.position_m and eye.look_at_m: expected both or neither");
  }
  if (eye.position_m) {
    checkPose(study, {.position_m = *eye.position_m, .look_at_m = *eye.look_at_m, .up = eye.up},
              "eye");
  } else if (eye.path.empty() && study.scene.file) {
    refuse(study, "eye.position_m: expected for a scene from a file, as is eye.look_at_m");
  }
  for (std::size_t i = 0; i < eye.path.size(); ++i) {
    const std::string name = "eye.path[" + std::to_string(i) + "]";
    checkPose(study, eye.path[i], name);
    if (i > 0 && !(eye.path[i].time_s > eye.path[i - 1].time_s)) {
      refuse(study, name + ".time_s = " + exactText(eye.path[i].time_s) +
                        ": expected later than the keyframe before");
    }
  }
}

bool wavefrontHasPower(const Study::Observer& observer) {
  const auto has = [](const std::optional<Wavefront>& eye) {
    return eye && power_D(*eye) != glm::dvec3(0.0);
  };
  if (!observer.wavefront.file) {
    return has(Wavefront{.zernike_um = observer.wavefront.zernike_um, .pupil_m = 1e-3});
  }
  const MeasuredEyes eyes = readWavefronts(*observer.wavefront.file, observer.wavefront_pupil_mm);
  return has(eyes.left) || has(eyes.right);
}

void checkObserver(const Study& study) {
  const Study::Observer& observer = study.observer;
  if (study.screen.spectra) readSpectra(*study.screen.spectra);
  if (observer.field.file) readFieldAberrations(*observer.field.file);
  if (!observer.wavefront.zernike_um.empty() && !observer.wavefront_pupil_mm) {
    refuse(study,
           "observer.wavefront: expected observer.wavefront_pupil_mm, too, the pupil that the "
           "coefficients hold for");
  }
  if (!observer.wavefront.zernike_um.empty() && observer.wavefront.zernike_um.size() < 4) {
    refuse(study, "observer.wavefront: expected more than piston and tilt, indices 0 to 2");
  }
  if (!observer.corrected && (observer.sphere_D != 0.0 || observer.cylinder_D != 0.0) &&
      wavefrontHasPower(observer)) {
    refuse(study,
           "observer.wavefront: its second order (indices 3 to 5) is the refraction; expected "
           "neither sphere_D nor cylinder_D beside it");
  }
  if (!observer.wavefront.file) return;
  const MeasuredEyes eyes = readWavefronts(*observer.wavefront.file, observer.wavefront_pupil_mm);
  const StereoView view = study.output.view;
  const bool left_seen = view != StereoView::mono && view != StereoView::right;
  const bool right_seen = view != StereoView::mono && view != StereoView::left;
  if ((left_seen && !eyes.left) || (right_seen && !eyes.right)) {
    refuse(study, "observer.wavefront: the file has no " +
                      std::string(eyes.left ? "right" : "left") +
                      " eye, which output.view = " + write(view) + " shows");
  }
}

void checkOutput(const Study& study) {
  const glm::ivec2 size_px = study.imageSize_px();
  const StereoView view = study.output.view;
  if ((view == StereoView::side_by_side && size_px.x % 2 != 0) ||
      (view == StereoView::top_bottom && size_px.y % 2 != 0)) {
    refuse(study, "output.view = " + write(view) +
                      ": expected images of an even number of px, to be halved");
  }
  if (study.output.seconds && !(study.output.seconds->y > study.output.seconds->x)) {
    refuse(study, "output.seconds = " + write(*study.output.seconds) + ": expected from before to");
  }
  const bool both = view == StereoView::side_by_side || view == StereoView::top_bottom ||
                    view == StereoView::anaglyph;
  if (!study.output.maps.empty() && both) {
    refuse(study,
           "output.maps: expected output.view = \"mono\", \"left\" or \"right\": one eye has "
           "one distance");
  }
}

}  // namespace

void checkStudy(const Study& study) {
  for (const auto& q : {study.display.left_eye_rotation, study.display.right_eye_rotation}) {
    if (q && !(glm::length(*q) > 1e-3)) {
      refuse(study,
             "display.left_eye_rotation, right_eye_rotation: expected quaternions x, y, z, "
             "w that are not 0");
    }
  }
  checkGaze(study);
  checkEye(study);
  checkObserver(study);
  checkOutput(study);
}

namespace {

EyeField fieldOf(const glm::dvec4& deg) {
  return {.left_deg = deg.x, .right_deg = deg.y, .up_deg = deg.z, .down_deg = deg.w};
}

}  // namespace

EyeField Study::Display::field() const { return field_deg ? fieldOf(*field_deg) : EyeField{}; }

HeadsetEyes Study::headsetEyes() const {
  const double ipd_m = observer.ipd_mm / 1000.0;
  const auto turn = [](const std::optional<glm::dvec4>& q) {
    return q ? glm::normalize(glm::dquat(q->w, q->x, q->y, q->z)) : glm::dquat(1.0, 0.0, 0.0, 0.0);
  };
  HeadsetEye left{.position_m = display.left_eye_m.value_or(glm::dvec3(-0.5 * ipd_m, 0.0, 0.0)),
                  .head_from_eye = turn(display.left_eye_rotation),
                  .field = display.field()};
  HeadsetEye right{.position_m = display.right_eye_m.value_or(glm::dvec3(0.5 * ipd_m, 0.0, 0.0)),
                   .head_from_eye = turn(display.right_eye_rotation),
                   .field = left.field};
  std::swap(right.field.left_deg, right.field.right_deg);
  if (display.right_field_deg) right.field = fieldOf(*display.right_field_deg);
  return {left, right};
}

TraceColumns Study::columnsInForce() const {
  TraceColumns columns = gaze.columns;
  columns.mapped_later = gaze.map.has_value();
  if (display.field_deg) columns.field = display.field();
  columns.pixels_per_degree = display.pixels_per_degree;
  return columns;
}

glm::ivec2 Study::imageSize_px() const {
  if (output.size_px) return *output.size_px;
  if (display.kind == DisplayKind::screen || output.view == StereoView::mono) {
    return screenInForce().size_px;
  }
  const EyeField field =
      output.view == StereoView::anaglyph ? fieldOfBothEyes(headsetEyes()) : display.field();
  return viewsAcross(output.view) * headsetScreen(field, display.pixels_per_degree).size_px;
}

Screen Study::screenInForce() const {
  if (display.kind == DisplayKind::headset) {
    return headsetScreen(fieldOfBothEyes(headsetEyes()), display.pixels_per_degree);
  }
  return screen;
}

namespace {

/// Whether the text is one TOML value.
bool isTomlValue(const std::string& text) {
  try {
    return parseToml("value = " + text, "").table().size() == 1;
  } catch (const std::exception&) {
    return false;
  }
}

/// Sets a key to a TOML value, or to the text itself where the key does not take it as TOML: a file
/// named 2024, a column named 3.
void setToText(Study& study, const std::string& key, const std::string& text,
               const std::string& where) {
  if (text != "null" && !isTomlValue(text)) {
    setKey(study, key, quotedText(text), where);
    return;
  }
  try {
    setKey(study, key, text, where);
  } catch (const InputError& refusal) {
    try {
      setKey(study, key, quotedText(text), where);
    } catch (const InputError&) {
      throw InputError(refusal.what());
    }
  }
}

}  // namespace

void setKeyByOption(Study& study, const std::string& assignment) {
  const std::size_t at = assignment.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == assignment.size()) {
    throw InputError("--set " + shownName(assignment),
                     "expected KEY=VALUE, e.g. observer.pupil_mm=3");
  }
  const std::string key = assignment.substr(0, at), value = assignment.substr(at + 1);
  const std::string where = "--set";
  setToText(study, key, value, where);
  for (const auto& [one, other] : kExclusive) {
    if (value != "null" && key == one) setKey(study, other, "null", where);
    if (value != "null" && key == other) setKey(study, one, "null", where);
  }
  if (key == "screen.monitor" && study.screen.monitor) {
    overrideKey(study, key, study.screen.monitor->string(), where);  // reads the monitor
  }
  if (decidesAngles(key)) study.screen.is_default = false;
}

}  // namespace foci
