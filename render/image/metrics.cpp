#include "render/image/metrics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/quality/qualityssim.hpp>

#include "render/image/frame_mat.h"

namespace foci {
namespace {

constexpr int kStraddle_px = 3;
constexpr float kStep = 0.05f;       // of the vergence; chosen by hand, as is the straddle
constexpr double kSsimPeak = 255.0;  // the peak that OpenCV's constants assume

double squaredDifference(const glm::vec4& a, const glm::vec4& b) {
  const glm::dvec3 difference = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(difference, difference);
}

double psnrOfSum_dB(double sum, std::size_t pixels) {
  return -10.0 * std::log10(sum / (3.0 * static_cast<double>(pixels)));
}

cv::Mat rgbForSsim(const Frame& frame) {
  cv::Mat rgb;
  cv::cvtColor(rgbaMat(frame), rgb, cv::COLOR_RGBA2RGB);
  return rgb * kSsimPeak;
}

/// Adds a disc to the band, row by row.
void stampDisc(std::vector<std::uint8_t>& band, const glm::ivec2& size_px, const glm::ivec2& at,
               const glm::vec2& radius_px) {
  const auto reach_y = static_cast<int>(radius_px.y);
  for (int dy = -reach_y; dy <= reach_y; ++dy) {
    const int y = at.y + dy;
    if (y < 0 || y >= size_px.y) continue;
    const float share = static_cast<float>(dy) / radius_px.y;
    const auto half =
        static_cast<int>(radius_px.x * std::sqrt(std::max(0.0f, 1.0f - share * share)));
    const int from = std::max(at.x - half, 0), to = std::min(at.x + half, size_px.x - 1);
    std::fill_n(band.begin() + static_cast<std::ptrdiff_t>(y) * size_px.x + from, to - from + 1,
                std::uint8_t{1});
  }
}

}  // namespace

double psnr_dB(const Frame& a, const Frame& b) {
  assert(a.size_px == b.size_px);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += squaredDifference(a.rgba[i], b.rgba[i]);
  return psnrOfSum_dB(sum, a.rgba.size());
}

double ssim(const Frame& a, const Frame& b) {
  assert(a.size_px == b.size_px);
  cv::ocl::setUseOpenCL(false);  // the same result on a machine with a graphics card
  const cv::Scalar channels =
      cv::quality::QualitySSIM::compute(rgbForSsim(a), rgbForSsim(b), cv::noArray());
  return (channels[0] + channels[1] + channels[2]) / 3.0;
}

double coverageError(const Frame& a, const Frame& b) {
  assert(a.size_px == b.size_px);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    sum += std::abs(static_cast<double>(a.rgba[i].a) - b.rgba[i].a);
  }
  return sum / static_cast<double>(a.rgba.size());
}

std::vector<std::uint8_t> silhouetteBand(const Frame& pinhole, const Defocus& defocus) {
  assert(pinhole.depth_m.size() == pinhole.rgba.size());
  const glm::ivec2 size_px = pinhole.size_px;
  std::vector<std::uint8_t> band(pinhole.rgba.size(), 0);
  cv::Mat vergence_D(size_px.y, size_px.x, CV_32FC1);
  for (std::size_t i = 0; i < band.size(); ++i) {
    vergence_D.ptr<float>()[i] = pinhole.rgba[i].a >= 0.5f ? 1.0f / pinhole.depth_m[i] : 0.0f;
  }
  cv::medianBlur(vergence_D, vergence_D, 3);
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      glm::vec2 reach_px(-1.0f);
      for (const glm::ivec2 step : {glm::ivec2(kStraddle_px, 0), glm::ivec2(0, kStraddle_px)}) {
        const glm::ivec2 low = glm::ivec2(x, y) - step, high = glm::ivec2(x, y) + step;
        if (low.x < 0 || low.y < 0 || high.x >= size_px.x || high.y >= size_px.y) continue;
        const std::array<float, 3> d = {vergence_D.at<float>(low.y, low.x),
                                        vergence_D.at<float>(y, x),
                                        vergence_D.at<float>(high.y, high.x)};
        const float max_D = std::max({d[0], d[1], d[2]});
        if (!(std::abs(d[0] - 2.0f * d[1] + d[2]) > kStep * max_D)) continue;
        for (const float one_D : d) {
          if (one_D > 0.0f) reach_px = glm::max(reach_px, blurRadius_px(defocus, one_D));
        }
      }
      if (reach_px.x < 0.0f) continue;
      const glm::vec2 max_px(static_cast<float>(size_px.x + size_px.y));  // and not infinity
      stampDisc(band, size_px, {x, y}, glm::min(reach_px + float{kStraddle_px}, max_px));
    }
  }
  return band;
}

std::optional<double> silhouettePsnr_dB(const Frame& a, const Frame& b,
                                        const std::vector<std::uint8_t>& band) {
  assert(a.size_px == b.size_px && band.size() == a.rgba.size());
  double sum = 0.0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < band.size(); ++i) {
    if (band[i] == 0) continue;
    sum += squaredDifference(a.rgba[i], b.rgba[i]);
    ++pixels;
  }
  if (pixels == 0) return std::nullopt;
  return psnrOfSum_dB(sum, pixels);
}

}  // namespace foci
