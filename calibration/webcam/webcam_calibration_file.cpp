// Webcam calibrations on disk. The view of the head is a PNG in base64 (RFC 4648), so that one file
// holds all.
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "calibration/calibration_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

constexpr std::uint32_t kMaxImage_px = 4096;
constexpr double kLargest = 1e12;
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

/// Whether a PNG's header says that it is no larger than `max_px`: told before it is unpacked,
/// since a few bytes may say that they are gigabytes.
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

template <class Numbers>
std::string list(const Numbers& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + exactText(value);
  return text + "]";
}

}  // namespace

std::string webcamCalibrationToml(const WebcamCalibration& calibration) {
  const WebcamReference& reference = calibration.reference;
  const HeadPose& pose = reference.view.pose;
  std::vector<double> rotation, position, eyes;
  for (int i = 0; i < 3; ++i) {
    position.push_back(pose.position_mm[i]);
    for (int k = 0; k < 3; ++k) rotation.push_back(pose.camera_from_head[i][k]);
  }
  for (const glm::dvec3& eye : reference.eyes_mm) {
    for (int k = 0; k < 3; ++k) eyes.push_back(eye[k]);
  }
  std::vector<unsigned char> png;
  cv::imencode(".png", reference.view.grey, png);
  return "# Webcam calibration of foci: the turn of the eyes along x and y by 1, x, y, xy, x^2, "
         "y^2\n"
         "# of the iris's offset in eye widths; gains of yaw and pitch; the camera's place in m.\n"
         "[webcam]\nparameters = " +
         list(calibration.map.parameters) + "\nsd_deg = " + exactText(calibration.map.sd_deg) +
         "\nscreen_m = " + exactText(calibration.screen_m) +
         "\n# Inverse covariance of the parameters.\ninformation = " +
         list(calibration.map.information) +
         "\n\n# The observer's head as the features are measured against it: column by column, "
         "mm.\n"
         "[reference]\nfocal_px = " +
         exactText(reference.camera.focal_px) +
         "\nprincipal_px = " + exactText(reference.camera.principal_px) +
         "\ndistortion = " + list(reference.camera.distortion) + "\nsize_px = [" +
         std::to_string(reference.camera.size_px.x) + ", " +
         std::to_string(reference.camera.size_px.y) + "]" +
         "\ncorner_px = " + exactText(reference.view.corner_px) + "\nrotation = " + list(rotation) +
         "\nposition_mm = " + list(position) + "\neyes_mm = " + list(eyes) + "\nimage = \"" +
         encoded(png) + "\"\n";
}

WebcamCalibration readWebcamCalibration(const std::filesystem::path& file) {
  CalibrationFile in(file);
  WebcamCalibration calibration;
  const auto parameters =
      in.numbers("webcam.parameters", WebcamMap::kParameters, -kLargest, kLargest);
  std::copy(parameters.begin(), parameters.end(), calibration.map.parameters.begin());
  calibration.map.information = in.numbers(
      "webcam.information", WebcamMap::kParameters * WebcamMap::kParameters, -kLargest, kLargest);
  calibration.map.sd_deg = in.number("webcam.sd_deg", 0.0, 180.0);
  calibration.screen_m = in.pair("webcam.screen_m", 0.01, 20.0);
  WebcamReference& reference = calibration.reference;
  reference.camera.focal_px = in.pair("reference.focal_px", 10.0, 1e6);
  reference.camera.principal_px = in.pair("reference.principal_px", -1e6, 1e6);
  const auto distortion = in.numbers("reference.distortion", 5, -100.0, 100.0);
  std::copy(distortion.begin(), distortion.end(), reference.camera.distortion.begin());
  reference.camera.size_px = in.size_px("reference.size_px");
  reference.view.corner_px = in.pair("reference.corner_px", -1e6, 1e6);
  const auto rotation = in.numbers("reference.rotation", 9, -1.0, 1.0);
  const auto position = in.numbers("reference.position_mm", 3, -1e5, 1e5);
  const auto eyes = in.numbers("reference.eyes_mm", 6, -1e3, 1e3);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    reference.view.pose.position_mm[i] = position[at];
    reference.eyes_mm[0][i] = eyes[at];
    reference.eyes_mm[1][i] = eyes[at + 3];
    for (int k = 0; k < 3; ++k) {
      reference.view.pose.camera_from_head[i][k] = rotation[3 * at + static_cast<std::size_t>(k)];
    }
  }
  const glm::dmat3& r = reference.view.pose.camera_from_head;
  constexpr double kRounding = 1e-6;
  if (std::abs(glm::determinant(r) - 1.0) > kRounding ||
      std::abs(glm::dot(r[0], r[1])) > kRounding || std::abs(glm::length(r[2]) - 1.0) > kRounding) {
    in.refuse("reference.rotation", "a rotation");
  }
  if (!(reference.view.pose.position_mm.z > 50.0)) {
    in.refuse("reference.position_mm", "a head before the camera");
  }
  const auto png = decoded(in.word("reference.image"));
  if (png && isSmallPng(*png, kMaxImage_px)) {
    reference.view.grey = cv::imdecode(*png, cv::IMREAD_GRAYSCALE);
  }
  const cv::Mat& grey = reference.view.grey;
  if (grey.empty() || grey.cols < 32 || grey.rows < 32) {
    in.refuse("reference.image", "a PNG in base64, 32 to 4096 px");
  }
  in.refuseRest();
  return calibration;
}

}  // namespace foci
