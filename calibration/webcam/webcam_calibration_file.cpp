// Webcam calibrations on disk. One TOML file holds all: the view of the head is a PNG in base64
// (RFC 4648).
#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>

#include "calibration/calibration_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

constexpr std::uint32_t kMaxImage_px = 4096;
constexpr double kMaxNumber = 1e12;
constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string encoded(const std::vector<unsigned char>& bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    }
    const std::size_t digits = std::min<std::size_t>(bytes.size() - i, 3) + 1;
    for (std::size_t k = 0; k < 4; ++k) {
      text += k < digits ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::optional<std::vector<unsigned char>> decoded(std::string_view text) {
  std::vector<unsigned char> bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) return std::nullopt;
    group = (group << 6 | static_cast<unsigned>(digit)) & 0xFFFFFFu;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(group >> bits & 255u));
    }
  }
  return bytes;
}

/// Whether a PNG's header states at most `max_px` by `max_px`. Checked before unpacking: a few
/// bytes can state gigabytes.
bool isSmallPng(const std::vector<unsigned char>& bytes, std::uint32_t max_px) {
  constexpr std::array<unsigned char, 8> kMagic = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() < 24 || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) return false;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | bytes[i];
    return value;
  };
  return number(16) <= max_px && number(20) <= max_px;
}

std::string headToml(const HeadView& view) {
  std::vector<unsigned char> png;
  cv::imencode(".png", view.grey, png);
  return "\ncorner_px = " + exactText(view.corner_px) +
         "\nrotation = " + exactText(view.pose.camera_from_head) +
         "\nposition_mm = " + exactText(std::span(&view.pose.position_mm.x, 3)) + "\nimage = \"" +
         encoded(png) + "\"\n";
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
  const auto png = decoded(in.text("reference.image"));
  if (png && isSmallPng(*png, kMaxImage_px)) view.grey = cv::imdecode(*png, cv::IMREAD_GRAYSCALE);
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
