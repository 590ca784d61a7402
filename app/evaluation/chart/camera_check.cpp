// Compares the sharp image of another renderer's camera with the one expected.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "app/evaluation/chart/cases.h"
#include "base/text.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// A change that leaves less than this share of the squared difference is what went wrong. Chosen
/// by hand, as are the next two: images of two renderers differ in sampling at every edge.
constexpr double kExplained = 0.5;
constexpr double kMinShift_px = 0.2;
/// An image of the same view explains at least half of the variance.
constexpr double kSameView = 0.5;

/// Light clamped to the display's, so that a lamp does not outweigh the rest.
cv::Mat lightMat(const Frame& frame) {
  cv::Mat rgb(frame.size_px.y, frame.size_px.x, CV_32FC3);
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
    const glm::vec4 shown = glm::clamp(frame.rgba[i], 0.0f, 1.0f);
    rgb.ptr<cv::Vec3f>()[i] = {shown.r, shown.g, shown.b};
  }
  return rgb;
}

cv::Mat mapped(const cv::Mat& image, float (*curve)(float)) {
  cv::Mat to = image.clone();
  for (auto pixel = to.begin<cv::Vec3f>(); pixel != to.end<cv::Vec3f>(); ++pixel) {
    for (int c = 0; c < 3; ++c) (*pixel)[c] = curve((*pixel)[c]);
  }
  return to;
}

cv::Mat flipped(const cv::Mat& image, int code) {
  cv::Mat to;
  cv::flip(image, to, code);
  return to;
}

double squaredDifference(const cv::Mat& a, const cv::Mat& b) {
  const double norm = cv::norm(a, b, cv::NORM_L2);
  return norm * norm;
}

/// How far `image` lies from `expected`, px: the peak of their phase correlation.
cv::Point2d shiftOf(const cv::Mat& image, const cv::Mat& expected) {
  cv::Mat grey, expected_grey, window;
  cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
  cv::cvtColor(expected, expected_grey, cv::COLOR_RGB2GRAY);
  cv::createHanningWindow(window, grey.size(), CV_32F);
  return cv::phaseCorrelate(expected_grey, grey, window);
}

cv::Mat movedBy(const cv::Mat& image, const cv::Point2d& by_px) {
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1.0, 0.0, by_px.x, 0.0, 1.0, by_px.y);
  cv::Mat to;
  cv::warpAffine(image, to, move, image.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return to;
}

}  // namespace

std::string cameraFault(const Frame& sharp, const Frame& expected) {
  assert(sharp.size_px == expected.size_px);
  const cv::Mat image = lightMat(sharp), wanted = lightMat(expected);
  const cv::Point2d shift_px = shiftOf(image, wanted);
  std::vector<std::pair<std::string, cv::Mat>> corrected = {
      {"is mirrored left to right", flipped(image, 1)},
      {"is mirrored top to bottom", flipped(image, 0)},
      {"is upside down", flipped(image, -1)},
      {"is too bright, as if its values were of sRGB and not of linear light",
       mapped(image, linearFromSrgb)},
      {"is too dark, as if its values were of linear light and not of sRGB",
       mapped(image, srgbFromLinear)}};
  if (std::hypot(shift_px.x, shift_px.y) >= kMinShift_px) {
    corrected.emplace_back("is shifted by " + decimal(shift_px.x, 1) + " px to the right and " +
                               decimal(shift_px.y, 1) + " px down",
                           movedBy(image, -shift_px));
  }
  const double apart = squaredDifference(image, wanted);
  const auto best = std::ranges::min_element(
      corrected, {}, [&](const auto& one) { return squaredDifference(one.second, wanted); });
  if (squaredDifference(best->second, wanted) < kExplained * apart) return best->first;
  const double variance =
      squaredDifference(wanted, cv::Mat(wanted.size(), wanted.type(), cv::mean(wanted)));
  if (apart > kSameView * variance) {
    return "shows another view, or other light, than the case's sharp image";
  }
  return "";
}

}  // namespace foci
