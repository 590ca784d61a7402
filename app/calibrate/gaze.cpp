// `foci calibrate gaze`: from tables, from a video, or in its window.
#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "app/calibrate/options.h"
#include "app/calibrate/windows.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/gaze_report.h"
#include "calibration/screen/screen_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

GazeFrame frameOf(const CalibrateGazeOptions& options, Warnings& warnings) {
  const auto units = mapUnitsNamed(options.units.empty() ? "deg" : options.units);
  if (!units) {
    throw InputError("--units", options.units + ": expected deg, norm or direction");
  }
  GazeFrame frame{.units = *units, .screen = defaultScreen()};
  if (!options.screen.empty()) {
    frame.screen = readScreen(options.screen).screen;
  } else if (frame.units == MapUnits::norm) {
    const Screen& screen = frame.screen;
    warnings.add("no --screen: degrees assume a screen of " + decimal(screen.size_m.x, 2) + " x " +
                 decimal(screen.size_m.y, 2) + " m at " + decimal(screen.distance_m, 2) + " m");
  }
  return frame;
}

/// Degrees are assumed, unless stated: fractions of the screen and radians are far smaller.
/// @param position  of a target, deg
template <class Target>
void refuseOtherUnits(const CalibrateGazeOptions& options, const std::vector<Target>& targets,
                      glm::dvec2 Target::*position) {
  constexpr double kSmall_deg = 1.5;  // a screen that ends here is 3 cm wide at 0.6 m
  if (!options.units.empty() || std::ranges::any_of(targets, [&](const Target& target) {
        const glm::dvec2 at = glm::abs(target.*position);
        return std::max(at.x, at.y) > kSmall_deg;
      })) {
    return;
  }
  throw InputError(options.pairs.string(),
                   "all x_target and y_target lie within " + decimal(kSmall_deg, 1) +
                       " deg: state their unit with --units deg, norm or direction, and convert "
                       "radians to degrees");
}

GazeReport fromFiles(const CalibrateGazeOptions& options, const GazeFrame& frame,
                     std::optional<GazeModel> model) {
  const auto pairs = readGazePairs(options.pairs, frame.units);
  refuseOtherUnits(options, pairs, &GazePair::target);
  std::vector<GazePair> other;
  if (!options.validate.empty()) other = readGazePairs(options.validate, frame.units);
  refuseOwnSamples(options.validate, pairs, other,
                   [](const GazePair& pair) { return pair.gaze.has_value(); });
  GazeReport report;
  try {
    report.fit = fitGazeMap(pairs, frame, model);
  } catch (const InputError& error) {
    throw InputError(options.pairs.string(), error.what());
  }
  report.validated = !other.empty();
  if (!report.validated) other = keptPairs(pairs, report.fit);
  report.accuracy = measureAccuracy(other, frame, &report.fit.map);
  return report;
}

/// Moves a map by the mean miss at a single target.
void correctDriftOf(const CalibrateGazeOptions& options, OutputFiles& files) {
  if (options.pairs.empty())
    throw InputError("--drift", "needs --pairs with samples of one target");
  const GazeMap map = readGazeMap(options.drift);
  std::vector<glm::dvec2> gaze;
  std::optional<glm::dvec2> target;
  for (const GazePair& pair : readGazePairs(options.pairs, map.frame.units)) {
    if (target && *target != pair.target) {
      throw InputError(options.pairs.string(), "more than one target: expected one");
    }
    target = pair.target;
    if (pair.gaze) gaze.push_back(*pair.gaze);
  }
  const GazeMap corrected = correctDrift(map, gaze, *target);
  if (!options.out.empty()) files.write(options.out, gazeMapToml(corrected));
  files.commit();
  const glm::dvec2 moved = corrected.coefficients[0] - map.coefficients[0];
  const double drift_deg =
      angle_deg(onPlane(map.frame, *target - moved), onPlane(map.frame, *target));
  std::printf(options.json ? "{\"drift_deg\": %.17g, \"samples\": %zu}\n"
                           : "moved by %.2f deg, from %zu samples\n",
              drift_deg, gaze.size());
}

std::optional<Lens> cameraOf(const CalibrateGazeOptions& options) {
  if (options.camera.empty()) return std::nullopt;
  return lensOf(readCamera(options.camera));
}

/// Fits a webcam's map to a video of the observer's face and a table of the targets shown.
GazeReport fromVideo(const CalibrateGazeOptions& options, const WebcamPlace& place,
                     const Screen& screen, WebcamCalibration& calibration, Warnings& warnings) {
  const auto targets = readShownTargets(options.pairs);
  refuseOtherUnits(options, targets, &ShownTarget::target_deg);
  std::vector<ShownTarget> others;
  if (!options.validate.empty()) others = readShownTargets(options.validate);
  refuseOwnSamples(options.validate, targets, others, [](const ShownTarget&) { return true; });
  WebcamTracker tracker(cameraOf(options));
  const WebcamRecording recording = readWebcam(place, tracker);
  const auto reference = tracker.reference();
  if (!reference) throw InputError(nameOf(place), "no frame shows a face");
  warnings.addAll(nameOf(place), recording.warnings);
  calibration.reference = *reference;
  calibration.screen_m = screen.size_m;
  return calibrateWebcam(pairFrames(recording.frames, targets),
                         pairFrames(recording.frames, others), screen, calibration.map);
}

/// @param who  needs degrees
void refuseUnits(const CalibrateGazeOptions& options, const std::string& who) {
  if (!options.units.empty() && options.units != "deg") {
    throw InputError("--units", who + " needs deg");
  }
}

void refuseWindowOptions(const CalibrateGazeOptions& options) {
  if (options.source != "mouse" && !webcamPlaceOf(options.source)) {
    throw InputError("--source",
                     options.source.substr(0, 40) + ": expected mouse or webcam[:N|FILE|PATTERN]");
  }
  constexpr std::array<int, 4> kCounts{5, 9, 13, 16};
  if (std::ranges::find(kCounts, options.targets) == kCounts.end()) {
    throw InputError("--targets", std::to_string(options.targets) + ": expected 5, 9, 13 or 16");
  }
  refuseUnits(options, "the window");
}

/// The file of the report; empty if there is none.
std::filesystem::path reportOf(const CalibrateGazeOptions& options) {
  if (!options.report.empty() || options.out.empty()) return options.report;
  return std::filesystem::path(options.out).replace_extension(".html");
}

/// @throws InputError if an output must not be written
OutputGuard guardOf(const CalibrateGazeOptions& options) {
  const auto webcam = webcamPlaceOf(options.source);
  return {{options.out, options.drift.empty() ? reportOf(options) : ""},
          {options.pairs, options.validate, options.drift, options.screen, options.camera,
           webcam ? webcam->file : ""},
          options.overwrite};
}

}  // namespace

void calibrateGaze(const CalibrateGazeOptions& options) {
  std::optional<GazeModel> model;
  if (options.model != "auto") {
    model = gazeModelNamed(options.model);
    if (!model) {
      throw InputError("--model",
                       options.model + ": expected auto, offset, affine, second or third");
    }
  }
  OutputFiles files(guardOf(options));
  if (!options.drift.empty()) {
    correctDriftOf(options, files);
    return;
  }
  Warnings warnings;
  const GazeFrame frame = frameOf(options, warnings);
  GazeReport report;
  const auto webcam = webcamPlaceOf(options.source);
  WebcamCalibration calibration;
  if (webcam && !options.pairs.empty()) {
    refuseUnits(options, "a webcam");
    report = fromVideo(options, *webcam, frame.screen, calibration, warnings);
  } else if (options.pairs.empty()) {
    if (!options.validate.empty()) throw InputError("--validate", "needs --pairs");
    refuseWindowOptions(options);
    auto result = calibrateGazeInWindow(options, frame.screen, webcam, cameraOf(options));
    if (!result) {
      std::fprintf(stderr, "left without a calibration\n");
      return;
    }
    report = result->report;
    if (result->webcam) calibration = std::move(*result->webcam);
  } else {
    report = fromFiles(options, frame, model);
  }

  report.warnings = warnings.all();
  const std::filesystem::path page = reportOf(options);
  if (!page.empty()) files.write(page, gazeReportHtml(report));
  if (!options.out.empty()) {
    files.write(options.out,
                webcam ? webcamCalibrationToml(calibration) : gazeMapToml(report.fit.map));
  }
  files.commit();
  const std::string summary = options.json ? gazeReportJson(report) : gazeReportText(report);
  std::fputs(summary.c_str(), stdout);
}

}  // namespace foci
