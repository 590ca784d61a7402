#include "render/image/image_file.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "base/input_error.h"
#include "render/image/frame_mat.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// Writes `image` beside `file` under its own extension, then renames.
void writeAside(const std::filesystem::path& file, const cv::Mat& image) {
  std::filesystem::path aside = file;
  aside.replace_filename("." + file.stem().string() + ".partial" + file.extension().string());
  bool written = false;
  try {
    written = cv::imwrite(aside.string(), image);
  } catch (const cv::Exception&) {
    written = false;
  }
  std::error_code error;
  if (written) std::filesystem::rename(aside, file, error);
  if (!written || error) {
    std::filesystem::remove(aside, error);
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

cv::Mat bgrOf(const Frame& frame) {
  cv::Mat bgr;
  cv::cvtColor(rgbaMat(frame), bgr, cv::COLOR_RGBA2BGR);
  return bgr;
}

}  // namespace

void checkImageExtension(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension != ".png" && extension != ".pfm" && extension != ".exr") {
    throw InputError(file.string(), "expected a name that ends in .png, .pfm or .exr");
  }
}

void writeImage(const std::filesystem::path& file, const Frame& frame,
                std::optional<double> gamma) {
  checkImageExtension(file);
  if (file.extension() == ".png") {
    std::vector<std::uint8_t> rgb = codesOf(frame, gamma);
    cv::Mat image(frame.size_px.y, frame.size_px.x, CV_8UC3, rgb.data());
    cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
    writeAside(file, image);
  } else {
    writeAside(file, bgrOf(frame));
  }
}

void writeMap(const std::filesystem::path& file, const glm::ivec2& size_px,
              const std::vector<float>& values) {
  writeAside(file, cv::Mat(size_px.y, size_px.x, CV_32FC1, const_cast<float*>(values.data())));
}

}  // namespace foci
