// Webcam calibrations on disk. One TOML file holds all: the view of the head is a PNG in base64
// (RFC 4648).
#include <algorithm>
#include <cctype>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "base/base64.h"
#include "base/image_codec.h"
#include "base/image_header.h"
#include "calibration/calibration_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

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
  const auto position = in.numbers("reference.position_mm", 3, -1e5, 1e5);
  view.pose.position_mm = {position[0], position[1], position[2]};
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

std::string webcamCalibrationToml(const WebcamCalibration& calibration) {
  const WebcamReference& reference = calibration.reference;
  std::vector<double> eyes;
  for (const glm::dvec3& eye : reference.eyes_mm) {
    for (int k = 0; k < 3; ++k) eyes.push_back(eye[k]);
  }
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
         "\nsize_px = " + exactText(reference.camera.size_px) + "\neyes_mm = " + exactText(eyes) +
         headToml(reference.head);
}

WebcamCalibration readWebcamCalibration(const std::filesystem::path& file) {
  CalibrationFile in(file);
  WebcamCalibration calibration;
  const auto parameters =
      in.numbers("webcam.parameters", WebcamMap::kParameters, -kMaxNumber, kMaxNumber);
  std::copy(parameters.begin(), parameters.end(), calibration.map.parameters.begin());
  calibration.map.information =
      in.numbers("webcam.information", WebcamMap::kParameters * WebcamMap::kParameters, -kMaxNumber,
                 kMaxNumber);
  calibration.map.sd_deg = in.number("webcam.sd_deg", 0.0, 180.0);
  calibration.screen_m = in.pair("webcam.screen_m", 0.01, 20.0);
  WebcamReference& reference = calibration.reference;
  reference.camera.focal_px = in.pair("reference.focal_px", 10.0, 1e6);
  reference.camera.principal_px = in.pair("reference.principal_px", -1e6, 1e6);
  const auto distortion = in.numbers("reference.distortion", 5, -100.0, 100.0);
  std::copy(distortion.begin(), distortion.end(), reference.camera.distortion.begin());
  reference.camera.size_px = in.size_px("reference.size_px");
  const auto eyes = in.numbers("reference.eyes_mm", 6, -1e3, 1e3);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    reference.eyes_mm[0][i] = eyes[at];
    reference.eyes_mm[1][i] = eyes[at + 3];
  }
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
