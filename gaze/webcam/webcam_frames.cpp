#include "gaze/webcam/webcam_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "base/image_codec.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/media.h"
#include "base/quiet_stderr.h"
#include "base/text.h"

namespace foci {

namespace {

constexpr std::string_view kPrefix = "webcam";
constexpr int kMinSide_px = 120, kMaxSide_px = 8192;
constexpr int kMaxDevices = 64;

bool isImage(const std::filesystem::path& file) {
  if (media()) return media()->isImage(file.string());
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  return statedImageSize(MappedFile(file).bytes()).has_value();
}

cv::Mat decoded(const std::filesystem::path& file) {
  if (media()) return media()->readImage(file.string());
  auto image = decodeImage(MappedFile(file).bytes());
  if (!image) return {};
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(image->rows, image->columns, CV_8UC4, image->rgba.data()), bgr,
               cv::COLOR_RGBA2BGR);
  return bgr;
}

/// FFmpeg would take text for a film of a terminal.
bool isText(const std::filesystem::path& file) {
  std::array<char, 512> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), bytes.size());
  return std::all_of(bytes.data(), bytes.data() + in.gcount(), [](char byte) {
    return (byte >= ' ' && byte <= '~') || (byte >= '\t' && byte <= '\r');
  });
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

cv::Mat readPhotograph(const std::filesystem::path& file) {
  requireRegularFile(file);
  requireWholeImage(file);
  cv::Mat read = decoded(file);
  if (read.empty()) throw InputError(file.string(), "no image that can be read");
  if (read.depth() == CV_8U) return read;
  if (read.depth() != CV_16U) {
    throw InputError(file.string(),
                     "an image of numbers that are not whole: expected 8 or 16 bits");
  }
  cv::Mat image;
  read.convertTo(image, CV_8U, 1.0 / 257.0);
  return image;
}

struct WebcamFrames::Capture {
  std::unique_ptr<VideoReader> video = media() ? media()->newReader() : nullptr;
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

std::string nameOf(const WebcamPlace& place) {
  return "webcam " + (place.device ? std::to_string(*place.device) : place.file.string());
}

WebcamFrames::WebcamFrames(const WebcamPlace& place)
    : place_(place), capture_(std::make_unique<Capture>()) {
  const QuietLibrary quiet;
  VideoReader* const video = capture_->video.get();
  if (place.device) {
    const std::string node = "/dev/video" + std::to_string(*place.device);
    if (!std::filesystem::exists(node) || !video || !video->openCamera(*place.device)) {
      throw InputError("webcam:" + std::to_string(*place.device),
                       "no camera that can be opened" + withoutMedia());
    }
  } else {
    const std::string name = place.file.string();
    std::error_code ignored;
    const bool exists = std::filesystem::exists(place.file, ignored);
    const std::regex pattern("([^%]*)%(0?)([1-9]?)d([^%]*)");
    std::smatch parts;
    if (!exists && std::regex_match(name, parts, pattern)) {
      before_number_ = parts[1];
      digits_ = parts[3].length() > 0 ? std::stoi(parts[3]) : 0;
      after_number_ = parts[4];
      first_ = std::filesystem::exists(image(0), ignored) ? 0 : 1;
      if (!std::filesystem::exists(image(0), ignored)) {
        throw InputError(name, "no such images: expected number 0 or 1 first");
      }
    }
    requireRegularFile(place.file);
    images_ = isPattern() || isImage(name);
    if (images_) return;
    if (!exists || isText(place.file) || !video || !video->open(name)) {
      throw InputError(name, "not a video or image that can be read" + withoutMedia());
    }
    stated_ = video->frames();
  }
  const double rate_Hz = video->rate_Hz();
  if (rate_Hz >= 5.0 && rate_Hz <= 1000.0) rate_Hz_ = rate_Hz;
}

std::filesystem::path WebcamFrames::image(std::size_t index) const {
  if (!isPattern()) return place_.file;
  std::string number = std::to_string(first_ + index);
  const auto digits = static_cast<std::size_t>(digits_);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return before_number_ + number + after_number_;
}

std::string WebcamFrames::remark() const {
  constexpr double kEnough = 0.95;  // of a count that may be an estimate from the duration
  const auto count = static_cast<double>(count_);
  if (isCamera() || grabbed_ || !(stated_ < 1e9) || count + 1.0 >= kEnough * stated_) return "";
  return "ends after " + std::to_string(count_) + " of the " + decimal(stated_, 0) +
         " frames that it states: the file may be damaged or cut off";
}

WebcamFrames::~WebcamFrames() = default;

bool WebcamFrames::grab() {
  if (grabbed_) return true;
  if (images_) {
    std::error_code ignored;
    if (isPattern() ? !std::filesystem::exists(image(count_), ignored) : count_ > 0) return false;
    last_s_ = static_cast<double>(count_++) / rate_Hz_;
    return grabbed_ = true;
  }
  VideoReader& video = *capture_->video;
  grabbed_ = video.grab();
  if (!grabbed_ || isCamera()) return grabbed_;
  constexpr double kRounding_s = 2e-3;  // stamps are often whole milliseconds
  const double stamp_s = video.time_s();
  if (!first_stamp_s_) first_stamp_s_ = stamp_s;
  const double since_s = stamp_s - *first_stamp_s_;
  const bool later = !last_s_ || since_s > *last_s_;
  const double nominal_s = static_cast<double>(count_++) / rate_Hz_;
  varies_ = varies_ || (later && since_s > 0.0 && std::abs(since_s - nominal_s) > kRounding_s);
  last_s_ = !varies_ ? nominal_s : later ? since_s : *last_s_ + 1.0 / rate_Hz_;
  return true;
}

std::optional<double> WebcamFrames::nextTime_s() {
  const QuietLibrary quiet;
  return grab() ? last_s_ : std::nullopt;
}

bool WebcamFrames::next(cv::Mat& frame) {
  const QuietLibrary quiet;
  if (isCamera() && !capture_->video->hasFrame()) return false;
  if (!grab()) return false;
  grabbed_ = false;
  if (images_) {
    capture_->image = readPhotograph(image(count_ - 1));
  } else if (!capture_->video->retrieve(capture_->image) || capture_->image.empty()) {
    return false;
  }
  const cv::Mat& image = capture_->image;
  const int shorter = std::min(image.cols, image.rows);
  const int longer = std::max(image.cols, image.rows);
  const std::string size = std::to_string(image.cols) + "x" + std::to_string(image.rows);
  if (shorter < kMinSide_px || longer > kMaxSide_px) {
    throw InputError(nameOf(place_), "frames of " + size + " px: expected sides of 120 to 8192 px");
  }
  if (capture_->size != cv::Size() && capture_->size != image.size()) {
    throw InputError(nameOf(place_), "a frame of " + size + " px: another size than those before");
  }
  capture_->size = image.size();
  image.copyTo(frame);
  return true;
}

}  // namespace foci
