#include "calibration/webcam/webcam_calibration.h"

#include <algorithm>
#include <cctype>
#include <opencv2/core.hpp>
#include <sstream>

#include "base/base64.h"
#include "base/image_codec.h"
#include "base/input_error.h"
#include "calibration/calibration_file.h"
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

// Chosen by hand: some hundreds of samples count as one or two clicks. The test
// WebcamRecalibration.LearnsFromEachClickOnceEyesAreSeen bounds it.
constexpr double kCalibrationShare = 0.005;
constexpr std::size_t kMaxClicks = 30;  // chosen by hand; older ones may be of another posture
constexpr std::chrono::milliseconds kMaxAge{300};  // about the duration of one fixation

constexpr std::uint64_t kMaxImage_px = 4096;
constexpr double kMaxNumber = 1e12;
std::string headToml(const HeadView& view) {
  std::ostringstream image;
  Base64 text(image);
  const auto png = encodePng(view.grey.cols, view.grey.rows, 1, view.grey.data);
  text.add(png.data(), png.size());
  text.finish();
  return "\ncorner_px = " + exactText(view.corner_px) +
         "\nrotation = " + exactText(view.pose.camera_from_head) +
         "\nposition_mm = " + exactText(std::span(&view.pose.position_mm.x, 3)) + "\nimage = \"" +
         image.str() + "\"\n";
}

HeadView readHeadView(CalibrationFile& in) {
  HeadView view;
  view.corner_px = in.pair("reference.corner_px", -1e6, 1e6);
  view.pose.camera_from_head = in.rotation("reference.rotation");
  in.read("reference.position_mm", std::span(&view.pose.position_mm.x, 3), -1e5, 1e5);
  if (!(view.pose.position_mm.z > 50.0)) {
    in.refuse("reference.position_mm", "a head more than 50 mm in front of the camera");
  }
  const std::string text = in.text("reference.image");
  const auto png = bytesOfBase64(text);
  const auto size = statedImageSize(png);
  const bool clean = std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '+' || c == '/' || c == '=';
  });
  if (clean && size && std::max(size->columns, size->rows) <= kMaxImage_px) {
    if (auto image = decodeImage(png)) {
      const cv::Mat rgba(image->rows, image->columns, CV_8UC4, image->rgba.data());
      cv::extractChannel(rgba, view.grey, 0);
    }
  }
  if (view.grey.empty() || view.grey.cols < 32 || view.grey.rows < 32) {
    in.refuse("reference.image", "a PNG in base64, 32 to 4096 px");
  }
  return view;
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
    if (std::ranges::find(targets, pair.target_deg) == targets.end()) {
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
    throw InputError(
        "gaze.map",
        printed("expected the calibrated screen of %.3f x %.3f m, not %.3f x %.3f m",
                calibration.screen_m.x, calibration.screen_m.y, screen.size_m.x, screen.size_m.y));
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

WebcamGaze WebcamRecalibration::gazeOf(const WebcamView& view) {
  WebcamMap map;
  {
    const std::lock_guard lock(mutex_);
    seen_ = {view, std::chrono::steady_clock::now()};
    map = map_;
  }
  return mappingOf(map, screen_)(view);
}

bool WebcamRecalibration::click(const glm::dvec2& point_px) {
  std::vector<WebcamSample> clicks;
  {
    const std::lock_guard lock(mutex_);
    if (!seen_ || std::chrono::steady_clock::now() - seen_->at > kMaxAge) return false;
    const glm::dvec2 m_per_px = screen_.size_m / glm::dvec2(screen_.size_px);
    const glm::dvec2 from_middle_m = (point_px - 0.5 * glm::dvec2(screen_.size_px)) * m_per_px;
    if (clicks_.size() == kMaxClicks) clicks_.erase(clicks_.begin());
    clicks_.push_back({seen_->view, {from_middle_m.x, -from_middle_m.y}});
    clicks = clicks_;
  }
  const WebcamMap fitted = fitWebcamMap(clicks, calibrated_, kCalibrationShare);
  const std::lock_guard lock(mutex_);
  map_ = fitted;
  return true;
}

std::string webcamCalibrationToml(const WebcamCalibration& calibration) {
  const WebcamReference& reference = calibration.reference;
  return "# Webcam calibration of foci. Parameters: the turn of the eyes along x and along y, each "
         "by\n"
         "# 1, x, y, xy, x^2, y^2 of the iris's offset in eye widths; gains of yaw and pitch; the\n"
         "# camera's position in m.\n"
         "[webcam]\nparameters = " +
         exactText(calibration.map.parameters) + "\nsd_deg = " + exactText(calibration.map.sd_deg) +
         "\nscreen_m = " + exactText(calibration.screen_m) +
         "\n# Inverse covariance of the parameters.\ninformation = " +
         exactText(calibration.map.information) +
         "\n\n# The view of the head against which features are measured, and the tracker: "
         "networks "
         "or cascades.\n[reference]\ntracker = " +
         (reference.by_networks ? "\"networks\"" : "\"cascades\"") +
         "\nfocal_px = " + exactText(reference.camera.focal_px) +
         "\nprincipal_px = " + exactText(reference.camera.principal_px) +
         "\ndistortion = " + exactText(reference.camera.distortion) +
         "\nsize_px = " + exactText(reference.camera.size_px) +
         "\neyes_mm = " + exactText(std::span(&reference.eyes_mm[0].x, 6)) +
         headToml(reference.head);
}

WebcamCalibration readWebcamCalibration(const std::filesystem::path& file) {
  CalibrationFile in(file);
  WebcamCalibration calibration;
  in.read("webcam.parameters", calibration.map.parameters, -kMaxNumber, kMaxNumber);
  calibration.map.information =
      in.numbers("webcam.information", WebcamMap::kParameters * WebcamMap::kParameters, -kMaxNumber,
                 kMaxNumber);
  calibration.map.sd_deg = in.number("webcam.sd_deg", 0.0, 180.0);
  calibration.screen_m = in.pair("webcam.screen_m", 0.01, 20.0);
  WebcamReference& reference = calibration.reference;
  reference.camera.focal_px = in.pair("reference.focal_px", 10.0, 1e6);
  reference.camera.principal_px = in.pair("reference.principal_px", -1e6, 1e6);
  in.read("reference.distortion", reference.camera.distortion, -100.0, 100.0);
  reference.camera.size_px = in.size_px("reference.size_px");
  in.read("reference.eyes_mm", std::span(&reference.eyes_mm[0].x, 6), -1e3, 1e3);
  reference.head = readHeadView(in);
  if (in.has("reference.tracker")) {
    const std::string tracker = in.text("reference.tracker");
    reference.by_networks = tracker == "networks";
    if (!reference.by_networks && tracker != "cascades") {
      in.refuse("reference.tracker", "\"networks\" or \"cascades\"");
    }
  }
  in.refuseUnknownKeys();
  return calibration;
}

}  // namespace foci
