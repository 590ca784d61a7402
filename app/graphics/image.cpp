#include "app/graphics/image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>

#include "base/file.h"
#include "base/image_codec.h"
#include "base/input_error.h"
#include "base/media.h"
#include "base/quiet_stderr.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

constexpr int kJpegQuality = 88;  // chosen by eye

cv::Mat matOf(const Image& image) {
  return {image.size_px.y, image.size_px.x, CV_8UC3, const_cast<std::uint8_t*>(image.rgb.data())};
}

double markerRadius_px(const Image& image) { return std::max(10.0, image.size_px.y / 36.0); }

/// Of the bright ring. The black one under it is a pixel wider than twice this.
int markerWidth_px(const Image& image) { return std::max(2, image.size_px.y / 360); }

}  // namespace

Image imageOf(const Frame& frame, std::optional<double> gamma) {
  return {.size_px = frame.size_px, .rgb = codesOf(frame, gamma)};
}

Frame readImage(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  if (extension != ".exr" && extension != ".png") {
    throw InputError(file.string(), "expected a name that ends in .exr or .png");
  }
  requireRegularFile(file);
  if (!std::filesystem::exists(file)) throw InputError(file.string(), "cannot be read");
  requireWholeImage(file);
  const QuietStderr quiet;
  cv::Mat pixels = media() ? media()->readStored(file.string()) : cv::Mat();
  const int channels = pixels.channels();
  if (pixels.empty() || channels == 2) {
    throw InputError(file.string(), "cannot be read as an image" + withoutMedia());
  }
  const bool codes = extension == ".png";
  pixels.convertTo(pixels, CV_32F,
                   !codes                    ? 1.0
                   : pixels.depth() == CV_8U ? 1.0 / 255.0
                                             : 1.0 / 65535.0);
  Frame frame;
  frame.resize({pixels.cols, pixels.rows});
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
    const float* bgr = pixels.ptr<float>() + i * static_cast<std::size_t>(channels);
    glm::vec3 rgb = channels == 1 ? glm::vec3(bgr[0]) : glm::vec3(bgr[2], bgr[1], bgr[0]);
    for (int c = 0; c < 3 && codes; ++c) rgb[c] = linearFromSrgb(rgb[c]);
    if (!std::isfinite(rgb.r + rgb.g + rgb.b)) {
      throw InputError(file.string(), "has values that are not finite");
    }
    frame.rgba[i] = glm::vec4(rgb, 1.0f);
  }
  return frame;
}

void eraseMarker(Image& image, const glm::dvec2& point_px) {
  cv::Mat canvas = matOf(image);
  constexpr int kSoftened_px = 3;  // by the video's compression and by smooth edges
  cv::circle(canvas, cv::Point(glm::ivec2(point_px).x, glm::ivec2(point_px).y),
             static_cast<int>(std::lround(markerRadius_px(image))), cv::Scalar(0, 0, 0),
             2 * markerWidth_px(image) + 1 + 2 * kSoftened_px);
}

void drawMarker(Image& image, const glm::dvec2& point_px, bool broken) {
  const glm::dvec2 size_px(image.size_px);
  if (!glm::all(glm::greaterThanEqual(point_px, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(point_px, size_px))) {
    return;
  }
  cv::Mat canvas = matOf(image);
  const double radius_px = markerRadius_px(image);
  const int width_px = markerWidth_px(image);
  constexpr int kShift = 4;  // OpenCV takes sixteenths of a pixel; pixel centres lie at +0.5
  const auto fixed = [](double px) { return static_cast<int>(std::lround(px * (1 << kShift))); };
  const cv::Point centre(fixed(point_px.x - 0.5), fixed(point_px.y - 0.5));
  const cv::Size axes(fixed(radius_px), fixed(radius_px));
  const int arcs = broken ? 8 : 1;
  for (const auto& [color, width] : {std::pair{cv::Scalar(0, 0, 0), 2 * width_px + 1},
                                     std::pair{cv::Scalar(255, 214, 10), width_px}}) {
    for (int arc = 0; arc < arcs; ++arc) {
      const double from_deg = 360.0 * arc / arcs;
      cv::ellipse(canvas, centre, axes, 0.0, from_deg, from_deg + (broken ? 22.5 : 360.0), color,
                  width, cv::LINE_AA, kShift);
    }
  }
}

Image filledImage(const glm::ivec2& size_px, std::uint8_t value) {
  const std::size_t pixels = std::size_t(size_px.x) * std::size_t(size_px.y);
  return {.size_px = size_px, .rgb = std::vector<std::uint8_t>(3 * pixels, value)};
}

Image thumbnail(const Image& image, int width_px) {
  Image small =
      filledImage({width_px, std::max(1, image.size_px.y * width_px / image.size_px.x)}, 0);
  cv::Mat to = matOf(small);
  cv::resize(matOf(image), to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

Image differenceOf(const Frame& a, const Frame& b, float gain) {
  Frame difference{.size_px = a.size_px, .rgba = a.rgba, .depth_m = {}};
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    difference.rgba[i] = gain * glm::abs(a.rgba[i] - b.rgba[i]);
  }
  return imageOf(difference);
}

Image gridOf(const std::vector<std::vector<Image>>& rows, const std::vector<std::string>& titles) {
  constexpr int kGap_px = 8, kTitle_px = 28;
  const glm::ivec2 one_px = rows.front().front().size_px;
  const glm::ivec2 counts(static_cast<int>(titles.size()), static_cast<int>(rows.size()));
  Image grid = filledImage(counts * (one_px + kGap_px) - kGap_px + glm::ivec2(0, kTitle_px), 255);
  cv::Mat image = matOf(grid);
  for (int x = 0; x < counts.x; ++x) {
    const int left = x * (one_px.x + kGap_px);
    cv::putText(image, titles[static_cast<std::size_t>(x)], {left + 2, kTitle_px - 9},
                cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(40, 40, 40), 1, cv::LINE_AA);
    for (int y = 0; y < counts.y; ++y) {
      const int top = kTitle_px + y * (one_px.y + kGap_px);
      matOf(rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)])
          .copyTo(image(cv::Rect(left, top, one_px.x, one_px.y)));
    }
  }
  return grid;
}

std::string jpegOf(const Image& image) {
  const auto bytes = encodeJpeg(image.size_px.x, image.size_px.y, image.rgb.data(), kJpegQuality);
  return {bytes.begin(), bytes.end()};
}

std::string pngOf(const Image& image) {
  const auto bytes = encodePng(image.size_px.x, image.size_px.y, 3, image.rgb.data());
  return {bytes.begin(), bytes.end()};
}

Image imageOfPng(const std::string& png, const glm::ivec2& size_px) {
  const std::span bytes(reinterpret_cast<const unsigned char*>(png.data()), png.size());
  const auto stated = statedImageSize(bytes);
  if (!stated || stated->columns != static_cast<std::uint64_t>(size_px.x) ||
      stated->rows != static_cast<std::uint64_t>(size_px.y)) {
    return {};
  }
  const auto decoded = decodeImage(bytes);
  if (!decoded) return {};
  Image image{.size_px = size_px, .rgb = {}};
  image.rgb.reserve(3 * decoded->total());
  for (std::size_t i = 0; i < decoded->rgba.size(); i += 4) {
    image.rgb.insert(image.rgb.end(), &decoded->rgba[i], &decoded->rgba[i] + 3);
  }
  return image;
}

}  // namespace foci
