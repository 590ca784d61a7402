#include "render/image/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/quality/qualityssim.hpp>
#include <random>

namespace foci {
namespace FOCI_FILE {

constexpr double kExact = 1e-12;
constexpr double kFloatSums = 1e-5;                     // single-precision sums over a window
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // of SSIM, peak 1

Frame flat(int width, int height, const glm::vec4& rgba) {
  Frame frame;
  frame.size_px = {width, height};
  frame.rgba.assign(static_cast<std::size_t>(width) * height, rgba);
  return frame;
}

/// `mean` plus `amplitude` times a checkerboard of single pixels.
Frame checkerboard(float mean, float amplitude) {
  Frame frame = flat(64, 64, glm::vec4(1.0f));
  for (int i = 0; i < 64 * 64; ++i) {
    const float sign = (i % 64 + i / 64) % 2 == 0 ? 1.0f : -1.0f;
    frame.rgba[i] = glm::vec4(glm::vec3(mean + sign * amplitude), 1.0f);
  }
  return frame;
}

/// A row-wise frame whose vergence is `vergence_D(x, y)`; 0: no surface.
template <typename Vergence>
Frame pinholeOf(int width, int height, Vergence vergence_D) {
  Frame frame = flat(width, height, glm::vec4(0.5f, 0.5f, 0.5f, 1.0f));
  frame.depth_m.resize(frame.rgba.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float d = vergence_D(static_cast<float>(x), static_cast<float>(y));
      frame.rgba[y * width + x].a = d > 0.0f ? 1.0f : 0.0f;
      frame.depth_m[y * width + x] = d > 0.0f ? 1.0f / d : 0.0f;
    }
  }
  return frame;
}

Defocus lens(float radius_px_per_D, float focus_D) {
  return {.radius_px_per_D = glm::vec2(radius_px_per_D), .focus_D = focus_D};
}

TEST(Psnr, OfAConstantDifferenceIsItsLogarithm) {
  const Frame a = flat(8, 5, {0.5f, 0.25f, 0.0f, 1.0f}), b = flat(8, 5, {0.25f, 0.0f, 0.25f, 0.0f});
  EXPECT_NEAR(psnr_dB(a, b), -10.0 * std::log10(0.0625), kExact);  // alpha does not count
  EXPECT_EQ(psnr_dB(a, a), std::numeric_limits<double>::infinity());
}

// OpenCV's implementation takes frames of peak 255.
TEST(Ssim, IsThatOfOpenCv) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  for (const glm::ivec2 size_px : {glm::ivec2(64, 48), glm::ivec2(7, 5), glm::ivec2(1, 3)}) {
    Frame a = flat(size_px.x, size_px.y, glm::vec4(1.0f)), b = a;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
      a.rgba[i] = glm::vec4(value(random), value(random), value(random), 1.0f);
      b.rgba[i] = glm::mix(a.rgba[i], glm::vec4(value(random)), 0.4f);
    }
    const auto rgbOf = [](Frame& frame) {
      cv::Mat rgb;
      cv::cvtColor(cv::Mat(frame.size_px.y, frame.size_px.x, CV_32FC4, frame.rgba.data()), rgb,
                   cv::COLOR_RGBA2RGB);
      return cv::Mat(255.0 * rgb);
    };
    const cv::Scalar of = cv::quality::QualitySSIM::compute(rgbOf(a), rgbOf(b), cv::noArray());
    EXPECT_NEAR(ssim(a, b), (of[0] + of[1] + of[2]) / 3.0, kFloatSums) << size_px.x;
  }
}

TEST(Ssim, IsOneForEqualFrames) {
  const Frame a = checkerboard(0.4f, 0.3f);
  EXPECT_NEAR(ssim(a, a), 1.0, kFloatSums);
}

TEST(Ssim, OfTwoConstantsComparesTheirMeans) {
  for (const auto& [a, b] : {std::pair{0.5, 0.25}, {0.02, 0.01}, {1.0, 0.0}}) {
    const double expected = (2.0 * a * b + kC1) / (a * a + b * b + kC1);
    EXPECT_NEAR(ssim(flat(32, 32, glm::vec4(static_cast<float>(a))),
                     flat(32, 32, glm::vec4(static_cast<float>(b)))),
                expected, kFloatSums);
  }
}

TEST(Ssim, OfAPatternScaledComparesItsContrast) {
  // Equal means; the window averages the pattern away, and its variance is the amplitude squared.
  const double amplitude = 0.2;
  for (const double scale : {1.0, 0.5, 0.1, 0.0, -1.0}) {
    const double variance = amplitude * amplitude;
    const double expected =
        (2.0 * scale * variance + kC2) / ((1.0 + scale * scale) * variance + kC2);
    EXPECT_NEAR(ssim(checkerboard(0.4f, static_cast<float>(amplitude)),
                     checkerboard(0.4f, static_cast<float>(amplitude * scale))),
                expected, 1e-4)  // of the pattern, exp(-(1.5 pi)^2 / 2) is left in the mean
        << scale;
  }
}

TEST(CoverageError, IsTheMeanDifferenceOfAlphaAlone) {
  Frame a = flat(4, 4, glm::vec4(0.0f)), b = flat(4, 4, glm::vec4(0.9f, 0.9f, 0.9f, 0.0f));
  EXPECT_EQ(coverageError(a, b), 0.0);
  a.rgba[3].a = 0.5f;
  b.rgba[7].a = 0.25f;
  EXPECT_NEAR(coverageError(a, b), 0.75 / 16.0, kExact);
}

TEST(SilhouetteBand, IsEmptyOnAPlaneAtAnySlope) {
  const Frame plane =
      pinholeOf(64, 48, [](float x, float y) { return 0.2f + 0.05f * x + 0.02f * y; });
  const auto band = silhouetteBand(plane, lens(20.0f, 1.0f));
  EXPECT_EQ(silhouettePsnr_dB(plane, plane, band), std::nullopt);
}

TEST(SilhouetteBand, ReachesAsFarAsTheBlurOfEitherSide) {
  // 1 D left of the edge between columns 63 and 64, 0.5 D right of it. The second difference sees
  // the edge from 3 columns on either side, and the band reaches 3 px beyond that without blur.
  const Frame edge = pinholeOf(128, 32, [](float x, float) { return x < 64.0f ? 1.0f : 0.5f; });
  for (const auto& [radius_px_per_D, focus_D, blur_px] :
       {std::tuple{0.0f, 1.0f, 0}, {10.0f, 1.0f, 5}, {10.0f, 0.5f, 5}, {10.0f, 0.0f, 10}}) {
    const auto band = silhouetteBand(edge, lens(radius_px_per_D, focus_D));
    for (int x = 0; x < 128; ++x) {
      const bool within = x >= 64 - 3 - 3 - blur_px && x < 64 + 3 + 3 + blur_px;
      EXPECT_EQ(band[16 * 128 + x], within ? 1 : 0) << x << ", blur " << blur_px;
    }
  }
}

TEST(SilhouetteBand, TakesWhereNothingIsAsInfinitelyFarWithoutBlur) {
  const Frame edge = pinholeOf(32, 128, [](float, float y) { return y < 64.0f ? 1.0f : 0.0f; });
  const auto band = silhouetteBand(edge, lens(40.0f, 1.0f));
  for (int y = 0; y < 128; ++y) EXPECT_EQ(band[y * 32 + 16], y >= 58 && y < 70 ? 1 : 0) << y;
}

TEST(SilhouetteBand, IsFiniteUnderAnInfiniteBlur) {
  const Frame edge = pinholeOf(64, 64, [](float x, float) { return x < 32.0f ? 1.0f : 0.5f; });
  const auto band = silhouetteBand(edge, lens(std::numeric_limits<float>::infinity(), 0.1f));
  EXPECT_EQ(std::count(band.begin(), band.end(), 1), 64 * 64);
}

TEST(SilhouettePsnr, CountsTheBandAlone) {
  const Frame a = flat(10, 1, glm::vec4(0.5f));
  Frame b = a;
  std::vector<std::uint8_t> band(10, 0);
  EXPECT_EQ(silhouettePsnr_dB(a, b, band), std::nullopt);
  band[2] = band[3] = 1;
  b.rgba[7] = glm::vec4(0.0f);
  EXPECT_EQ(silhouettePsnr_dB(a, b, band), std::numeric_limits<double>::infinity());
  b.rgba[2].g = 0.0f;  // one of six values
  EXPECT_NEAR(*silhouettePsnr_dB(a, b, band), -10.0 * std::log10(0.25 / 6.0), kExact);
}

}  // namespace FOCI_FILE
}  // namespace foci
