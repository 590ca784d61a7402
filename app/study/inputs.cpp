#include "app/study/inputs.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

#include "app/study/gaze_calibration.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/live/simulator.h"
#include "gaze/sources/trace_doubts.h"
#include "gaze/sources/trace_reader.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/io/mesh_files.h"

namespace foci {
namespace {

constexpr double kSimulatedRate_Hz = 500.0;
constexpr double kSimulatedSpan_s = 20.0;
constexpr double kMaxSimulatedSpan_s = 3600.0;
// Longer than most fixations, so that focus settles on each target; chosen by hand.
constexpr double kMinDwell_s = 0.7, kMaxDwell_s = 2.1;

/// Points on the screen that a simulated observer looks at while the eye is at `eye_from_world`.
std::vector<glm::dvec2> attractivePoints_px(const Study& study, const glm::mat4& eye_from_world) {
  const Screen screen = study.screenInForce();
  const glm::dvec2 size_px(screen.size_px);
  std::vector<glm::dvec2> points_px;
  if (!study.scene.file && study.scene.builtin == "gallery") {
    const View view = viewThroughScreen(eye_from_world, screen.size_px, screen.size_m,
                                        screen.distance_m, screen.faced_m);
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
  const EyePath path = eyePathOf(study);
  // The standard specifies mt19937_64 to the bit, but not its distributions.
  std::mt19937_64 random(static_cast<std::uint64_t>(study.seed));
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };

  // Each round visits all points in a new order, and never begins where the last one ended.
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
  const WebcamCalibration calibration = webcamCalibrationOf(study);
  const Screen screen = study.screenInForce();
  WebcamTracker tracker(std::nullopt, calibration.reference);
  const WebcamMapping map = mappingOf(calibration.map, screen);
  GazeTrace trace{{.format = nameOf(place), .screen = screen}};
  WebcamRecording recording = readWebcam(place, tracker);
  trace.warnings = std::move(recording.warnings);
  for (const WebcamFrame& frame : recording.frames) trace.samples.push_back(sampleOf(frame, map));
  if (trace.samples.size() < 2) throw InputError(nameOf(place), "expected at least 2 frames");
  trace.rate_Hz = 1.0 / (trace.samples[1].time_s - trace.samples[0].time_s);
  const bool seen = std::ranges::any_of(trace.samples,
                                        [](const GazeSample& s) { return s.point_px.has_value(); });
  if (!seen)
    throw InputError(nameOf(place), "no eyes in any frame: expected a face before the camera");
  return trace;
}

GazeTrace loadNamedGaze(const Study& study) {
  if (study.gazeIsSimulated()) return simulate(study);
  if (const auto place = webcamPlaceOf(study.gaze.source)) return traceOfWebcam(study, *place);
  GazeTrace trace = readTrace(study.gaze.source, study.columnsInForce(), study.screenInForce(),
                              study.record.rate_Hz);
  if (trace.relative) {
    throw InputError(study.gaze.source,
                     "gaze.units = \"relative\": the place of the gaze is not known; expected "
                     "gaze.map, or foci events for labels alone");
  }
  if (!study.gaze.map) return trace;
  const GazeCalibration calibration = readGazeCalibration(*study.gaze.map, /*webcam=*/false);
  if (const auto* both_eyes = std::get_if<BinocularCalibration>(&calibration)) {
    return mapTrace(*both_eyes, study.screenInForce(), std::move(trace));
  }
  const Screen screen = *trace.screen;
  return mapTrace(std::get<GazeMap>(calibration), screen, std::move(trace));
}

}  // namespace

void addScreenDoubts(const Study& study, Warnings& warnings) {
  if (study.display.kind != DisplayKind::screen) return;
  for (const std::string& doubt : screenDoubts(study.screenInForce())) warnings.add(doubt);
}

GazeTrace loadGaze(const Study& study, Warnings& warnings) {
  GazeTrace trace = loadNamedGaze(study);
  warnings.addAll(study.gaze.source, trace.warnings);
  if (study.gazeIsSimulated() || webcamPlaceOf(study.gaze.source)) addScreenDoubts(study, warnings);
  trace.rate_Hz = study.record.rate_Hz.value_or(trace.rate_Hz);
  return trace;
}

void sayAssumptions(const Study& study, const GazeTrace& trace) {
  const std::string before = study.gaze.source + ": assumed: ";
  for (const std::string& assumption : trace.assumed) say(before + assumption);
}

std::vector<std::filesystem::path> inputFiles(const Study& study) {
  std::vector<std::filesystem::path> files = {study.file};
  if (study.scene.file) {
    if (*study.scene.file != study.file) files.push_back(*study.scene.file);
    for (auto& file : meshCompanions(*study.scene.file)) files.push_back(std::move(file));
  }
  for (const ScenePart& part : study.scene.parts) {
    files.push_back(part.file);
    for (auto& file : meshCompanions(part.file)) files.push_back(std::move(file));
  }
  for (const auto& file :
       {study.screen.monitor, study.screen.spectra, study.observer.wavefront.file,
        study.observer.field.file, study.gaze.map, study.gaze.camera, study.record.frames,
        study.record.changes, study.record.markers, study.record.head}) {
    if (file) files.push_back(*file);
  }
  if (const auto place = webcamPlaceOf(study.gaze.source)) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(place->file, ignored)) files.push_back(place->file);
  } else if (!study.gazeIsSimulated()) {
    std::error_code unreadable;
    const bool is_folder = std::filesystem::is_directory(study.gaze.source, unreadable);
    if (!is_folder) files.push_back(study.gaze.source);
    for (auto& file : companionsOf(study.gaze.source)) files.push_back(std::move(file));
  }
  return files;
}

}  // namespace foci
