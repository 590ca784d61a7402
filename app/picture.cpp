#include "app/picture.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "render/image/srgb.h"

namespace foci {
namespace {

constexpr int kJpegQuality = 88;

cv::Mat matOf(const Picture& picture) {
  return {picture.size_px.y, picture.size_px.x, CV_8UC3,
          const_cast<std::uint8_t*>(picture.rgb.data())};
}

}  // namespace

Picture pictureOf(const Frame& frame) { return {.size_px = frame.size_px, .rgb = srgb8(frame)}; }

void drawMarker(Picture& picture, const glm::dvec2& point_px, bool held) {
  const glm::dvec2 size_px(picture.size_px);
  if (!glm::all(glm::greaterThanEqual(point_px, glm::dvec2(0.0))) ||
      !glm::all(glm::lessThan(point_px, size_px))) {
    return;
  }
  cv::Mat image = matOf(picture);
  const double radius_px = std::max(10.0, size_px.y / 36.0);
  const int width_px = std::max(2, static_cast<int>(size_px.y / 360.0));
  constexpr int kShift = 4;  // centres in sixteenths of a pixel; pixel centres lie at +0.5
  const auto fixed = [](double px) { return static_cast<int>(std::lround(px * (1 << kShift))); };
  const cv::Point centre(fixed(point_px.x - 0.5), fixed(point_px.y - 0.5));
  const cv::Size axes(fixed(radius_px), fixed(radius_px));
  const int arcs = held ? 8 : 1;
  for (const auto& [color, width] : {std::pair{cv::Scalar(0, 0, 0), 2 * width_px + 1},
                                     std::pair{cv::Scalar(255, 214, 10), width_px}}) {
    for (int arc = 0; arc < arcs; ++arc) {
      const double from_deg = 360.0 * arc / arcs;
      cv::ellipse(image, centre, axes, 0.0, from_deg, from_deg + (held ? 22.5 : 360.0), color,
                  width, cv::LINE_AA, kShift);
    }
  }
}

void splitWithSharp(Picture& picture, const Picture& sharp) {
  const cv::Rect left(0, 0, picture.size_px.x / 2, picture.size_px.y);
  cv::Mat image = matOf(picture);
  matOf(sharp)(left).copyTo(image(left));
  cv::line(image, {left.width, 0}, {left.width, left.height - 1}, cv::Scalar(255, 255, 255), 1);
}

Picture thumbnail(const Picture& picture, int width_px) {
  Picture small{
      .size_px = {width_px, std::max(1, picture.size_px.y * width_px / picture.size_px.x)},
      .rgb = {}};
  small.rgb.resize(3u * static_cast<std::size_t>(small.size_px.x) *
                   static_cast<std::size_t>(small.size_px.y));
  cv::Mat to = matOf(small);
  cv::resize(matOf(picture), to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

std::vector<std::uint8_t> jpegOf(const Picture& picture) {
  cv::Mat bgr;
  cv::cvtColor(matOf(picture), bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return bytes;
}

}  // namespace foci
