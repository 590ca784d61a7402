#include "render/image/visible_difference.h"

#include <cassert>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "render/image/frame_mat.h"

namespace foci {
namespace {

constexpr double kEye_deg = 0.5 / 60.0;  // standard deviation of the blur of an eye in focus
constexpr float kJustNoticeable = 2.3f;

cv::Mat labOf(const Frame& frame, double px_per_deg) {
  cv::Mat rgb, lab;
  cv::cvtColor(rgbaMat(frame), rgb, cv::COLOR_RGBA2RGB);
  cv::min(rgb, 1.0, rgb);
  cv::max(rgb, 0.0, rgb);
  cv::GaussianBlur(rgb, rgb, {}, kEye_deg * px_per_deg, 0.0, cv::BORDER_REPLICATE);
  cv::cvtColor(rgb, lab, cv::COLOR_LRGB2Lab);
  return lab;
}

}  // namespace

std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg) {
  assert(a.size_px == b.size_px && px_per_deg > 0.0);
  const cv::Mat lab_a = labOf(a, px_per_deg), lab_b = labOf(b, px_per_deg);
  std::vector<float> difference(a.rgba.size());
  std::size_t i = 0;
  for (int y = 0; y < a.size_px.y; ++y) {
    for (int x = 0; x < a.size_px.x; ++x, ++i) {
      const cv::Vec3f apart = lab_a.at<cv::Vec3f>(y, x) - lab_b.at<cv::Vec3f>(y, x);
      difference[i] = static_cast<float>(cv::norm(apart)) / kJustNoticeable;
    }
  }
  return difference;
}

}  // namespace foci
