#include "gaze/webcam/webcam_frames.h"

#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "base/image_header.h"
#include "base/input_error.h"
#include "base/number.h"
#include "base/quiet_stderr.h"

namespace foci {
namespace {

constexpr std::string_view kPrefix = "webcam";
constexpr int kMinSide_px = 120, kMaxSide_px = 8192;
constexpr int kMaxDevices = 64;

bool isPattern(const std::filesystem::path& file) {
  return file.filename().string().find('%') != std::string::npos;
}

/// Silences OpenCV and the libraries below it while it lives: foci reports the errors itself.
class QuietLibrary {
 public:
  QuietLibrary() = default;
  ~QuietLibrary() { cv::utils::logging::setLogLevel(before_); }
  QuietLibrary(const QuietLibrary&) = delete;
  QuietLibrary& operator=(const QuietLibrary&) = delete;

 private:
  QuietStderr stderr_;
  cv::utils::logging::LogLevel before_ =
      cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
};

}  // namespace

struct WebcamFrames::Capture {
  std::vector<cv::VideoCapture> captures{1};  // one; cv::VideoCapture::waitAny takes a vector
  cv::Mat image;
  cv::Size size;
};

std::optional<WebcamPlace> webcamPlaceOf(std::string_view source) {
  if (!source.starts_with(kPrefix)) return std::nullopt;
  source.remove_prefix(kPrefix.size());
  if (source.empty()) return WebcamPlace{.device = 0};
  if (source.front() != ':') return std::nullopt;
  source.remove_prefix(1);
  if (source.empty()) throw InputError("webcam:", "expected a camera's number, a video or images");
  if (const auto device = parseInteger<int>(source)) {
    if (*device < 0 || *device >= kMaxDevices) {
      throw InputError("webcam:" + std::to_string(*device), "expected a camera, 0 to 63");
    }
    return WebcamPlace{.device = device};
  }
  return WebcamPlace{.file = std::filesystem::path(source)};
}

void refuseOtherThanFiles(const std::filesystem::path& video) {
  requireRegularFile(video);
  std::error_code ignored;
  if (!isPattern(video)) {
    if (std::filesystem::exists(video, ignored)) requireImagePixels(video);
    return;
  }
  const std::string name = video.filename().string();
  const std::string before = name.substr(0, name.find('%'));
  const auto folder = video.has_parent_path() ? video.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const auto& image = entry.path();
    if (image.extension() != video.extension()) continue;
    if (!image.filename().string().starts_with(before)) continue;
    requireRegularFile(image);
    requireImagePixels(image);
  }
}

std::string nameOf(const WebcamPlace& place) {
  return "webcam " + (place.device ? std::to_string(*place.device) : place.file.string());
}

WebcamFrames::WebcamFrames(const WebcamPlace& place)
    : place_(place), capture_(std::make_unique<Capture>()) {
  const QuietLibrary quiet;
  cv::VideoCapture& capture = capture_->captures.front();
  if (place.device) {
    const std::string node = "/dev/video" + std::to_string(*place.device);
    if (!std::filesystem::exists(node) || !capture.open(*place.device, cv::CAP_V4L2)) {
      throw InputError("webcam:" + std::to_string(*place.device), "no camera that can be opened");
    }
  } else {
    const std::string name = place.file.string();
    refuseOtherThanFiles(place.file);
    std::error_code ignored;
    picture_ = !isPattern(place.file) && cv::haveImageReader(name);
    if (picture_) return;
    const bool opened = isPattern(place.file)
                            ? capture.open(name, cv::CAP_IMAGES)
                            : std::filesystem::is_regular_file(place.file, ignored) &&
                                  capture.open(name, cv::CAP_FFMPEG);
    if (!opened) throw InputError(name, "no video or images that can be read");
  }
  const double rate_Hz = capture.get(cv::CAP_PROP_FPS);
  if (rate_Hz >= 5.0 && rate_Hz <= 1000.0 && !isPattern(place.file)) rate_Hz_ = rate_Hz;
}

WebcamFrames::~WebcamFrames() = default;

bool WebcamFrames::grab() {
  if (grabbed_) return true;
  if (picture_) {
    last_s_ = 0.0;
    return grabbed_ = capture_->image.empty();
  }
  cv::VideoCapture& capture = capture_->captures.front();
  grabbed_ = capture.grab();
  if (!grabbed_ || isCamera()) return grabbed_;
  constexpr double kRounding_s = 2e-3;  // stamps are often whole milliseconds
  const double stamp_s = 1e-3 * capture.get(cv::CAP_PROP_POS_MSEC);
  if (!first_stamp_s_) first_stamp_s_ = stamp_s;
  const double since_s = stamp_s - *first_stamp_s_;
  const bool later = !last_s_ || since_s > *last_s_;
  const double nominal_s = static_cast<double>(count_++) / rate_Hz_;
  varies_ = varies_ || (later && !isPattern(place_.file) && since_s > 0.0 &&
                        std::abs(since_s - nominal_s) > kRounding_s);
  last_s_ = !varies_ ? nominal_s : later ? since_s : *last_s_ + 1.0 / rate_Hz_;
  return true;
}

std::optional<double> WebcamFrames::nextTime_s() {
  const QuietLibrary quiet;
  return grab() ? last_s_ : std::nullopt;
}

bool WebcamFrames::next(cv::Mat& frame) {
  const QuietLibrary quiet;
  cv::VideoCapture& capture = capture_->captures.front();
  if (isCamera()) {
    std::vector<int> ready;
    constexpr int kAtOnce_ns = 1;
    if (!cv::VideoCapture::waitAny(capture_->captures, ready, kAtOnce_ns) || ready.empty()) {
      return false;
    }
  }
  if (!grab()) return false;
  grabbed_ = false;
  if (picture_) {
    capture_->image = cv::imread(place_.file.string());
    if (capture_->image.empty())
      throw InputError(place_.file.string(), "no image that can be read");
  } else if (!capture.retrieve(capture_->image) || capture_->image.empty()) {
    return false;
  }
  const cv::Mat& image = capture_->image;
  const int shorter = std::min(image.cols, image.rows);
  const int longer = std::max(image.cols, image.rows);
  const std::string size = std::to_string(image.cols) + "x" + std::to_string(image.rows);
  if (shorter < kMinSide_px || longer > kMaxSide_px) {
    throw InputError(nameOf(place_), "frames of " + size + " px: expected 120 to 8192");
  }
  if (capture_->size != cv::Size() && capture_->size != image.size()) {
    throw InputError(nameOf(place_), "a frame of " + size + " px: another size than those before");
  }
  capture_->size = image.size();
  image.copyTo(frame);
  return true;
}

}  // namespace foci
