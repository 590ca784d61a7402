// Without OpenCV: its first conversion to L*a*b* in a process takes longer than a frame, since it
// fills a table in software floating point and looks for OpenCL. `auto` compares squares in its
// first frame.

#include "render/image/metrics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "base/transformed.h"

namespace foci {
namespace {

constexpr int kStraddle_px = 3;
constexpr float kStep = 0.05f;  // of the vergence; chosen by hand, as is the straddle
constexpr float kSsimSigma_px = 1.5f, kSsimC1 = 0.01f * 0.01f, kSsimC2 = 0.03f * 0.03f;
constexpr int kSsimReach_px = 5;

double squaredDifference(const glm::vec4& a, const glm::vec4& b) {
  const glm::dvec3 difference = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(difference, difference);
}

double psnrOfSum_dB(double sum, std::size_t pixels) {
  return -10.0 * std::log10(sum / (3.0 * static_cast<double>(pixels)));
}

glm::vec4 meanOf(const Frame& frame) {
  glm::dvec4 sum(0.0);
  for (const glm::vec4& pixel : frame.rgba) sum += glm::dvec4(pixel);
  return glm::vec4(sum / static_cast<double>(frame.rgba.size()));
}

/// The mean under the window of SSIM at each pixel of f(a, b).
template <class Product>
std::vector<glm::vec4> windowMeans(const Frame& a, const Frame& b, Product product) {
  std::vector<float> kernel;
  float sum = 0.0f;
  for (int i = 0; i <= kSsimReach_px; ++i) {
    kernel.push_back(std::exp(-0.5f * static_cast<float>(i * i) / (kSsimSigma_px * kSsimSigma_px)));
    sum += (i == 0 ? 1.0f : 2.0f) * kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  std::vector<glm::vec4> pixels(a.rgba.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = product(a.rgba[i], b.rgba[i]);
  filterSeparably(pixels, a.size_px, kernel, ImageBorder::reflect);
  return pixels;
}

/// The median of 3 x 3 values; those of the edge go on beyond it.
std::vector<float> medianOf9(const std::vector<float>& values, const glm::ivec2& size_px) {
  std::vector<float> medians;
  medians.reserve(values.size());
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      std::array<float, 9> near{};
      for (int k = 0; k < 9; ++k) {
        const int column = std::clamp(x + k % 3 - 1, 0, size_px.x - 1);
        const int row = std::clamp(y + k / 3 - 1, 0, size_px.y - 1);
        near[static_cast<std::size_t>(k)] =
            values[static_cast<std::size_t>(row) * size_px.x + column];
      }
      std::nth_element(near.begin(), near.begin() + 4, near.end());
      medians.push_back(near[4]);
    }
  }
  return medians;
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

/// The Gaussian is cut off at this many standard deviations, where it is 0.0003 of its peak.
constexpr double kReach = 4.0;

/// Half of a Gaussian's samples from the middle on. All samples sum to one.
std::vector<float> gaussianFromMiddle(double sigma_px) {
  const auto reach_px = static_cast<std::size_t>(std::ceil(kReach * sigma_px));
  std::vector<double> half(reach_px + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i <= reach_px; ++i) {
    const double x = static_cast<double>(i) / sigma_px;
    half[i] = std::exp(-0.5 * x * x);
    sum += i == 0 ? half[i] : 2.0 * half[i];
  }
  return transformed(half, [&](double each) { return static_cast<float>(each / sum); });
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
  // Variances of small numbers lose few digits: each frame's mean is subtracted.
  const glm::vec4 mid_a = meanOf(a), mid_b = meanOf(b);
  const auto deviations_a =
      windowMeans(a, b, [&](const auto& p, const auto&) { return p - mid_a; });
  const auto deviations_b =
      windowMeans(a, b, [&](const auto&, const auto& q) { return q - mid_b; });
  const auto squares_a =
      windowMeans(a, b, [&](const auto& p, const auto&) { return (p - mid_a) * (p - mid_a); });
  const auto squares_b =
      windowMeans(a, b, [&](const auto&, const auto& q) { return (q - mid_b) * (q - mid_b); });
  const auto products =
      windowMeans(a, b, [&](const auto& p, const auto& q) { return (p - mid_a) * (q - mid_b); });
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < products.size(); ++i) {
    const glm::vec4 &da = deviations_a[i], &db = deviations_b[i];
    const glm::vec4 mean_a = mid_a + da, mean_b = mid_b + db;
    const glm::vec4 covariance = products[i] - da * db;
    const glm::vec4 variances = squares_a[i] - da * da + squares_b[i] - db * db;
    const glm::vec4 similar =
        (2.0f * mean_a * mean_b + kSsimC1) * (2.0f * covariance + kSsimC2) /
        ((mean_a * mean_a + mean_b * mean_b + kSsimC1) * (variances + kSsimC2));
    sum += glm::dvec3(similar);
  }
  return (sum.x + sum.y + sum.z) / (3.0 * static_cast<double>(products.size()));
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
  std::vector<float> vergence_D(band.size());
  for (std::size_t i = 0; i < band.size(); ++i) {
    vergence_D[i] = pinhole.rgba[i].a >= 0.5f ? 1.0f / pinhole.depth_m[i] : 0.0f;
  }
  vergence_D = medianOf9(vergence_D, size_px);
  const auto at = [&](const glm::ivec2& p) {
    return vergence_D[static_cast<std::size_t>(p.y) * size_px.x + p.x];
  };
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      glm::vec2 reach_px(-1.0f);
      for (const glm::ivec2 step : {glm::ivec2(kStraddle_px, 0), glm::ivec2(0, kStraddle_px)}) {
        const glm::ivec2 low = glm::ivec2(x, y) - step, high = glm::ivec2(x, y) + step;
        if (low.x < 0 || low.y < 0 || high.x >= size_px.x || high.y >= size_px.y) continue;
        const std::array<float, 3> d = {at(low), at({x, y}), at(high)};
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

std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg) {
  assert(a.size_px == b.size_px);
  return visibleDifference(a, labOf(b, px_per_deg), px_per_deg);
}

glm::vec3 labOf(const glm::vec3& rgb) {
  const auto curve = [](float t) {
    return t > kLinearBelow ? static_cast<float>(std::cbrt(double{t}))
                            : kLinearSlope * t + 16.0f / 116.0f;
  };
  const glm::vec3 xyz = kXyzOfWhite * rgb;
  return kLabOfCurve * glm::vec3(curve(xyz.x), curve(xyz.y), curve(xyz.z)) -
         glm::vec3(16.0f, 0.0f, 0.0f);
}

std::vector<glm::vec3> labOf(const Frame& frame, double px_per_deg) {
  assert(px_per_deg > 0.0);
  std::vector<glm::vec4> pixels = frame.rgba;
  for (glm::vec4& pixel : pixels) pixel = glm::clamp(pixel, 0.0f, 1.0f);
  filterSeparably(pixels, frame.size_px, gaussianFromMiddle(kEye_deg * px_per_deg),
                  ImageBorder::replicate);
  std::vector<glm::vec3> lab(pixels.size());
  parallelFor(lab.size(), [&](std::size_t i) { lab[i] = labOf(glm::vec3(pixels[i])); });
  return lab;
}

std::vector<float> visibleDifference(const Frame& a, const std::vector<glm::vec3>& lab_b,
                                     double px_per_deg) {
  assert(a.rgba.size() == lab_b.size());
  const std::vector<glm::vec3> lab_a = labOf(a, px_per_deg);
  std::vector<float> difference(a.rgba.size());
  for (std::size_t i = 0; i < difference.size(); ++i) {
    difference[i] = glm::distance(lab_a[i], lab_b[i]) / kJustNoticeable;
  }
  return difference;
}

glm::mat3 visibleDifferencePerLight(const glm::vec3& rgb) {
  const auto slope = [](float t) {
    const auto root = static_cast<float>(std::cbrt(double{t}));
    return t > kLinearBelow ? 1.0f / (3.0f * root * root) : kLinearSlope;
  };
  const glm::vec3 xyz = kXyzOfWhite * glm::clamp(rgb, 0.0f, 1.0f);
  glm::mat3 per_light = kXyzOfWhite;
  for (int i = 0; i < 3; ++i) {
    per_light[i] *= glm::vec3(slope(xyz.x), slope(xyz.y), slope(xyz.z)) / kJustNoticeable;
  }
  return kLabOfCurve * per_light;
}

}  // namespace foci
