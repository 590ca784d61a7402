// A study's file, and what only the whole of it can tell.
#include "app/study/study.h"

#include <algorithm>
#include <cmath>

#include "app/study/study_keys.h"
#include "app/study/toml_values.h"
#include "base/input_error.h"
#include "calibration/binocular/binocular_map.h"
#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_map_file.h"
#include "calibration/screen/screen_file.h"
#include "calibration/toml_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

void resolve(std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.is_relative()) path = (folder / path).lexically_normal();
}

/// The calibrated screen's own numbers, where the study names one.
void takeMonitor(Study& study) {
  if (!study.screen.monitor) return;
  const ScreenCalibration calibration = readScreen(*study.screen.monitor);
  const Screen& screen = calibration.screen;
  study.screen.size_px = screen.size_px;
  study.screen.size_m = screen.size_m;
  study.screen.distance_m = screen.distance_m;
  study.screen.gamma = calibration.gamma;
  study.screen.is_default = false;
}

}  // namespace

Study readStudy(const std::filesystem::path& file) {
  const toml::value document = readToml(file);
  Study study;
  study.file = file;
  const auto given = setKeys(study, document.as_table(), file.string());

  const auto refuseBoth = [&](const char* one, const char* other) {
    if (given.contains(one) && given.contains(other)) {
      throw InputError(file.string(),
                       std::string(one) + " and " + other + ": expected only one of them");
    }
  };
  refuseBoth("scene.file", "scene.builtin");
  refuseBoth("screen.monitor", "screen.size_px");
  refuseBoth("screen.monitor", "screen.size_m");
  refuseBoth("screen.monitor", "screen.distance_m");
  refuseBoth("screen.monitor", "screen.gamma");
  refuseBoth("eye.path", "eye.position_m");
  refuseBoth("eye.path", "eye.look_at_m");

  const std::filesystem::path folder = file.parent_path();
  if (study.scene.file) resolve(*study.scene.file, folder);
  if (study.screen.monitor) resolve(*study.screen.monitor, folder);
  if (study.gaze.map) resolve(*study.gaze.map, folder);
  if (study.gaze.camera) resolve(*study.gaze.camera, folder);
  if (study.record.frames) resolve(*study.record.frames, folder);
  if (study.record.changes) resolve(*study.record.changes, folder);
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
  study.screen.is_default = std::none_of(given.begin(), given.end(), [](const std::string& name) {
    // Light says nothing of angles.
    return name.starts_with("screen.") && name != "screen.gamma" &&
           name != "screen.luminance_cd_m2";
  });
  takeMonitor(study);
  return study;
}

void overrideKey(Study& study, std::string_view key, const OptionValue& value,
                 const std::string& option) {
  const toml::value toml = std::visit(
      [](const auto& v) -> toml::value {
        // Whole numbers may be meant for an integer key; a real key takes them as well.
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

void checkStudy(const Study& study) {
  const std::string file = study.file.string();
  const auto refuse = [&](const std::string& what) { throw InputError(file, what); };
  if (study.gaze.map && study.gazeIsSimulated()) {
    refuse("gaze.map: expected a recording to map, not simulated gaze");
  }
  if (webcamPlaceOf(study.gaze.source)) {
    if (!study.gaze.map) {
      refuse(
          "gaze.source: a webcam needs gaze.map (--gaze-map): foci calibrate gaze --source webcam");
    }
    readWebcamCalibration(*study.gaze.map);
  } else if (study.gaze.map && isBinocularFile(*study.gaze.map)) {
    readBinocular(*study.gaze.map);
  } else if (study.gaze.map) {
    readGazeMap(*study.gaze.map);
  }
  const TraceColumns& columns = study.gaze.columns;
  if (columns.rate_Hz && !columns.time.empty()) {
    refuse("gaze.rate_Hz and gaze.time: expected only one of them");
  }
  for (std::size_t side : {0, 1}) {
    if (columns.eyes[side].x.empty() != columns.eyes[side].y.empty()) {
      refuse(side == 0 ? "gaze.left_x and gaze.left_y: expected both or neither"
                       : "gaze.right_x and gaze.right_y: expected both or neither");
    }
  }
  if (study.gaze.camera) readCamera(*study.gaze.camera);
  const auto checkPose = [&](const glm::dvec3& position_m, const glm::dvec3& look_at_m,
                             const glm::dvec3& up, const std::string& name) {
    const glm::dvec3 sight = look_at_m - position_m;
    if (!(glm::length(sight) > 1e-6)) refuse(name + ": expected look_at_m away from position_m");
    if (!(glm::length(up) > 1e-6) ||
        !(glm::length(glm::cross(glm::normalize(sight), glm::normalize(up))) > 1e-4)) {
      refuse(name + ": expected up not along the line of sight");
    }
  };

  if (study.eye.position_m.has_value() != study.eye.look_at_m.has_value()) {
    refuse("eye.position_m and eye.look_at_m: expected both or neither");
  }
  if (study.eye.position_m) {
    checkPose(*study.eye.position_m, *study.eye.look_at_m, study.eye.up, "eye");
  } else if (study.eye.path.empty() && study.scene.file) {
    refuse("eye.position_m: expected for a scene from a file, as is eye.look_at_m");
  }
  for (std::size_t i = 0; i < study.eye.path.size(); ++i) {
    const EyeKeyframe& frame = study.eye.path[i];
    checkPose(frame.position_m, frame.look_at_m, frame.up.value_or(study.eye.up),
              "eye.path[" + std::to_string(i) + "]");
    if (i > 0 && !(frame.time_s > study.eye.path[i - 1].time_s)) {
      refuse("eye.path[" + std::to_string(i) + "].time_s = " + exactText(frame.time_s) +
             ": expected later than the keyframe before");
    }
  }
  const glm::ivec2 size_px = study.imageSize_px();
  if ((study.output.view == "side-by-side" && size_px.x % 2 != 0) ||
      (study.output.view == "top-bottom" && size_px.y % 2 != 0)) {
    refuse("output.view = \"" + study.output.view +
           "\": expected images of an even number of px, to be halved");
  }
  if (study.output.seconds && !(study.output.seconds->y > study.output.seconds->x)) {
    refuse("output.seconds = " + write(*study.output.seconds) + ": expected from before to");
  }
}

Screen Study::screenInForce() const {
  return {.size_px = screen.size_px, .size_m = screen.size_m, .distance_m = screen.distance_m};
}

}  // namespace foci
