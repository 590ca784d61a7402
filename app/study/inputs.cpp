#include "app/study/inputs.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>

#include "base/input_error.h"
#include "calibration/binocular/binocular_map.h"
#include "calibration/gaze_map/gaze_map_file.h"
#include "calibration/webcam/webcam_calibration.h"
#include "gaze/sources/simulator.h"
#include "gaze/sources/trace_reader.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/io/open_scene.h"

namespace foci {
namespace {

constexpr double kSimulatedRate_Hz = 500.0;
constexpr double kSimulatedSpan_s = 20.0;
constexpr double kMaxSimulatedSpan_s = 3600.0;
constexpr double kMinDwell_s = 0.7, kMaxDwell_s = 2.1;

/// Where the simulated observer may look at the moment of `eye_from_world`: points on the screen.
std::vector<glm::dvec2> attractivePoints_px(const Study& study, const glm::mat4& eye_from_world) {
  const Screen screen = study.screenInForce();
  const glm::dvec2 size_px(screen.size_px);
  std::vector<glm::dvec2> points_px;
  if (!study.scene.file && study.scene.builtin == "gallery") {
    const View view =
        viewThroughScreen(eye_from_world, screen.size_px, screen.size_m, screen.distance_m);
    for (const PointOfInterest& point : galleryPointsOfInterest()) {
      const glm::vec3 p_eye(eye_from_world * glm::vec4(point.p_world, 1.0f));
      if (p_eye.z > -view.near_m) continue;
      const glm::dvec2 point_px(project(view, p_eye));
      if (glm::all(glm::greaterThan(point_px, glm::dvec2(0.0))) &&
          glm::all(glm::lessThan(point_px, size_px))) {
        points_px.push_back(point_px);
      }
    }
  }
  if (points_px.size() < 2) {
    points_px.clear();
    for (const double y : {0.2, 0.4, 0.6, 0.8}) {
      for (const double x : {0.2, 0.35, 0.5, 0.65, 0.8})
        points_px.push_back(size_px * glm::dvec2(x, y));
    }
  }
  return points_px;
}

GazeTrace simulate(const Study& study) {
  const double span_s = study.output.seconds ? study.output.seconds->y : kSimulatedSpan_s;
  if (span_s > kMaxSimulatedSpan_s) {
    throw InputError(study.file.string(),
                     "output.seconds: a simulated observer looks for an hour at most, 0 to 3600");
  }
  const EyePath path(study);
  // mt19937_64 is specified to the bit, the standard distributions are not.
  std::mt19937_64 random(static_cast<std::uint64_t>(study.seed));
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };

  // Rounds over all points, each in an order of its own, without staying at a seam.
  std::vector<GazeTarget> targets;
  std::vector<std::size_t> round;
  std::size_t points = 0, last = 0;
  for (double time_s = 0.0; time_s < span_s;) {
    const auto points_px = attractivePoints_px(study, path.eyeFromWorldAt(time_s));
    if (round.empty() || points_px.size() != points) {
      points = points_px.size();
      round.resize(points);
      std::iota(round.begin(), round.end(), std::size_t{0});
      for (std::size_t i = round.size(); i > 1; --i) std::swap(round[i - 1], round[below(i)]);
      if (round.back() == last) std::swap(round.front(), round.back());
    }
    last = round.back();
    round.pop_back();
    const double share = static_cast<double>(below(1000)) / 1000.0;
    const double dwell_s =
        std::min(kMinDwell_s + share * (kMaxDwell_s - kMinDwell_s), span_s - time_s);
    targets.push_back({.point_px = points_px[last], .dwell_s = dwell_s});
    time_s += dwell_s;
  }
  return simulateGaze(targets, study.screenInForce(), kSimulatedRate_Hz,
                      static_cast<std::uint64_t>(study.seed))
      .trace;
}

/// A webcam's video as a recording on the study's screen.
GazeTrace traceOfWebcam(const Study& study, const WebcamPlace& place) {
  const WebcamCalibration calibration = readWebcamCalibration(*study.gaze.map);
  const Screen screen = study.screenInForce();
  std::optional<Lens> camera;
  if (study.gaze.camera) camera = lensOf(readCamera(*study.gaze.camera));
  requireSame(calibration, screen, camera);
  WebcamTracker tracker(std::nullopt, calibration.reference);
  const WebcamMapping map = mappingOf(calibration.map, screen);
  GazeTrace trace{.format = nameOf(place), .screen = screen};
  for (const WebcamFrame& frame : readWebcam(place, tracker)) {
    trace.samples.push_back(sampleOf(frame, map));
  }
  if (trace.samples.size() < 2) throw InputError(nameOf(place), "expected at least 2 frames");
  trace.rate_Hz = 1.0 / (trace.samples[1].time_s - trace.samples[0].time_s);
  const bool seen = std::any_of(trace.samples.begin(), trace.samples.end(),
                                [](const GazeSample& s) { return s.point_px.has_value(); });
  if (!seen)
    throw InputError(nameOf(place), "no eyes in any frame: expected a face before the camera");
  return trace;
}

}  // namespace

EyePose builtinPose(const Study& study) {
  return study.scene.builtin == "plane" ? planeEyePose() : galleryEyePose();
}

EyePath::EyePath(const Study& study)
    : file_(study.file.string()), up_(study.eye.up), keyframes_(study.eye.path) {
  if (!keyframes_.empty()) return;
  if (study.eye.position_m) {
    keyframes_.push_back({.position_m = *study.eye.position_m,
                          .look_at_m = *study.eye.look_at_m,
                          .up = study.eye.up});
  } else {
    const EyePose pose = builtinPose(study);
    keyframes_.push_back(
        {.position_m = pose.position_m, .look_at_m = pose.target_m, .up = pose.up});
  }
}

glm::mat4 EyePath::eyeFromWorldAt(double time_s) const {
  const auto after = std::find_if(keyframes_.begin(), keyframes_.end(),
                                  [&](const EyeKeyframe& frame) { return frame.time_s > time_s; });
  const EyeKeyframe& to = after == keyframes_.end() ? keyframes_.back() : *after;
  const EyeKeyframe& from = after == keyframes_.begin() ? keyframes_.front() : *std::prev(after);
  const double share =
      &from == &to ? 0.0 : std::clamp((time_s - from.time_s) / (to.time_s - from.time_s), 0.0, 1.0);
  const glm::vec3 position_m(glm::mix(from.position_m, to.position_m, share));
  const glm::vec3 look_at_m(glm::mix(from.look_at_m, to.look_at_m, share));
  const glm::vec3 up(glm::mix(from.up.value_or(up_), to.up.value_or(up_), share));
  const float side = glm::length(glm::cross(look_at_m - position_m, up));
  if (!(side > 0.0f)) {
    throw InputError(file_, "eye.path: at " + std::to_string(time_s) +
                                " s the line of sight is none, or along up");
  }
  return eyeFromWorld(position_m, look_at_m, glm::normalize(up));
}

SurfelCloud loadScene(const Study& study) {
  if (!study.scene.file) return study.scene.builtin == "plane" ? makePlane() : makeGallery();
  const glm::mat4 world_from_eye = glm::inverse(EyePath(study).eyeFromWorldAt(0.0));
  OpenedScene scene =
      openScene(*study.scene.file, study.scene.scale_m, glm::vec3(world_from_eye[3]));
  if (scene.dropped > 0) {
    std::fprintf(stderr, "%s: %zu points left out: their position is not finite\n",
                 study.scene.file->c_str(), scene.dropped);
  }
  return std::move(scene.cloud);
}

TraceColumns columnsOf(const Study& study) {
  TraceColumns columns = study.gaze.columns;
  if (study.gaze.units == "px") columns.units = GazeUnits::px;
  if (study.gaze.units == "deg") columns.units = GazeUnits::deg;
  if (study.gaze.units == "normalised") columns.units = GazeUnits::normalised;
  return columns;
}

namespace {

GazeTrace loadNamedGaze(const Study& study) {
  if (study.gazeIsSimulated()) return simulate(study);
  if (const auto place = webcamPlaceOf(study.gaze.source)) return traceOfWebcam(study, *place);
  GazeTrace trace =
      readTrace(study.gaze.source, columnsOf(study), study.screenInForce(), study.record.rate_Hz);
  if (study.gaze.map && isBinocularFile(*study.gaze.map)) {
    trace = mapTrace(readBinocular(*study.gaze.map), study.screenInForce(), std::move(trace));
  } else if (study.gaze.map) {
    const GazeMap map = readGazeMap(*study.gaze.map);
    const Screen screen = *trace.screen;
    trace = mapTrace(map, screen, std::move(trace));
  }
  return trace;
}

}  // namespace

GazeTrace loadGaze(const Study& study) {
  GazeTrace trace = loadNamedGaze(study);
  trace.rate_Hz = study.record.rate_Hz.value_or(trace.rate_Hz);
  return trace;
}

std::vector<std::filesystem::path> inputFiles(const Study& study) {
  std::vector<std::filesystem::path> files = {study.file};
  if (study.scene.file) files.push_back(*study.scene.file);
  for (const auto& file : {study.screen.monitor, study.gaze.map, study.gaze.camera,
                           study.record.frames, study.record.changes}) {
    if (file) files.push_back(*file);
  }
  if (const auto place = webcamPlaceOf(study.gaze.source)) {
    if (std::filesystem::is_regular_file(place->file)) files.push_back(place->file);
  } else if (!study.gazeIsSimulated()) {
    files.push_back(study.gaze.source);
  }
  return files;
}

}  // namespace foci
