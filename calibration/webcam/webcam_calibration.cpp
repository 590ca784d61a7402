#include "calibration/webcam/webcam_calibration.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "base/input_error.h"
#include "calibration/gaze_map/map_units.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr double kLook_s = 0.5;  // latency of a saccade (0.2 s), the saccade, and a correction
constexpr std::size_t kMinWebcamTargets = 5;
constexpr std::size_t kMaxTargets = 10000;
constexpr double kSameScreen = 0.01;  // relative difference; chosen by hand

glm::dvec2 pointOnScreen_deg(const WebcamMap& map, const WebcamView& view, const Screen& screen) {
  return glm::degrees(glm::atan(pointOnScreen_m(map, view) / screen.distance_m));
}

std::vector<GazePair> mapped(std::span<const WebcamPair> pairs, const WebcamMap& map,
                             const Screen& screen) {
  std::vector<GazePair> gaze;
  for (const WebcamPair& pair : pairs) {
    GazePair& one = gaze.emplace_back();
    one.target = pair.target_deg;
    one.time_s = pair.time_s;
    if (pair.view) one.gaze = pointOnScreen_deg(map, *pair.view, screen);
  }
  return gaze;
}

}  // namespace

std::vector<ShownTarget> readShownTargets(const std::filesystem::path& file) {
  constexpr double kMax_s = 86400.0, kMax_deg = 80.0;
  NamedTable table(file, "onset_s duration_s x_target y_target");
  const std::size_t onset = table.column("onset_s"), duration = table.column("duration_s");
  const std::size_t x = table.column("x_target"), y = table.column("y_target");
  std::vector<ShownTarget> targets;
  while (table.next()) {
    if (targets.size() == kMaxTargets) throw table.error("more than 10000 targets");
    targets.push_back(
        {table.needed(onset, 0.0, kMax_s),
         table.needed(duration, 0.0, kMax_s),
         {table.needed(x, -kMax_deg, kMax_deg), table.needed(y, -kMax_deg, kMax_deg)}});
  }
  if (targets.empty()) throw InputError(file.string(), "no rows below the header");
  return targets;
}

std::vector<WebcamPair> pairFrames(std::span<const WebcamFrame> frames,
                                   std::span<const ShownTarget> targets) {
  std::vector<WebcamPair> pairs;
  for (const ShownTarget& target : targets) {
    const double from_s = target.onset_s + std::min(kLook_s, 0.5 * target.duration_s);
    for (const WebcamFrame& frame : frames) {
      if (frame.time_s < from_s || frame.time_s >= target.onset_s + target.duration_s) continue;
      pairs.push_back({frame.record.view, frame.time_s, target.target_deg});
    }
  }
  return pairs;
}

GazeReport calibrateWebcam(std::span<const WebcamPair> pairs, std::span<const WebcamPair> other,
                           const Screen& screen, WebcamMap& map) {
  std::vector<WebcamSample> samples;
  std::vector<glm::dvec2> targets;
  for (const WebcamPair& pair : pairs) {
    if (!pair.view) continue;
    const glm::dvec2 target_m = screen.distance_m * glm::tan(glm::radians(pair.target_deg));
    samples.push_back({*pair.view, target_m});
    if (std::find(targets.begin(), targets.end(), pair.target_deg) == targets.end()) {
      targets.push_back(pair.target_deg);
    }
  }
  if (targets.size() < kMinWebcamTargets) {
    throw InputError("webcam", "eyes in view at " + std::to_string(targets.size()) +
                                   " targets: expected at least 5");
  }
  const auto start = std::chrono::steady_clock::now();
  map = fitWebcamMap(samples, nominalWebcamMap());
  GazeReport report;
  report.fit.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  report.model = "webcam";
  report.fit.map.frame = {.units = MapUnits::deg, .screen = screen};
  report.validated = !other.empty();
  report.accuracy = measureAccuracy(mapped(other.empty() ? pairs : other, map, screen),
                                    report.fit.map.frame, nullptr);
  return report;
}

Lens lensOf(const CameraModel& camera) {
  return {{.focal_px = camera.focal_px, .principal_px = camera.principal_px},
          camera.distortion,
          camera.size_px};
}

void requireSame(const WebcamCalibration& calibration, const Screen& screen,
                 const std::optional<Lens>& camera) {
  const glm::dvec2 ratio = screen.size_m / calibration.screen_m;
  if (glm::any(glm::greaterThan(glm::abs(ratio - 1.0), glm::dvec2(kSameScreen)))) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "expected the calibrated screen of %.3f x %.3f m, not %.3f x %.3f m",
                  calibration.screen_m.x, calibration.screen_m.y, screen.size_m.x, screen.size_m.y);
    throw InputError("gaze.map", text);
  }
  if (camera && !(*camera == calibration.reference.camera)) {
    throw InputError("gaze.camera",
                     "expected the camera that gaze.map was calibrated with, or none");
  }
}

WebcamMapping mappingOf(const WebcamMap& map, const Screen& screen) {
  return [map, screen](const WebcamView& view) {
    const glm::dvec2 px_per_m = glm::dvec2(screen.size_px) / screen.size_m;
    const glm::dvec2 point_m = pointOnScreen_m(map, view);
    return WebcamGaze{
        .point_px = 0.5 * glm::dvec2(screen.size_px) + glm::dvec2(point_m.x, -point_m.y) * px_per_m,
        .uncertainty_deg = kGaussianSigmaRadius * map.sd_deg};
  };
}

}  // namespace foci
