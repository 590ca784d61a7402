#include "render/methods/halos.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "render/gl/image.h"
#include "render/methods/mean_of_parts.h"

namespace foci {
namespace {

/// Half a turn in this many directions: those of the rings of 6 and 12 parts.
constexpr int kDirections = 6;

/// Gaussians are applied at a scale where they are at least this wide, in samples.
constexpr double kLeastSigma = 2.5;

int directionOf(const LensPart& part) {
  const double turns = std::atan2(double{part.centre.y}, double{part.centre.x}) / std::numbers::pi;
  const int nearest = static_cast<int>(std::lround(kDirections * turns));
  return (nearest + 2 * kDirections) % kDirections;
}

/// The nearer to the rim, the more of a part's light is in the halos.
float haloWeight(const LensPart& part) { return part.weight * glm::length(part.centre); }

cv::Mat imageOf(Frame& frame) {
  return {frame.size_px.y, frame.size_px.x, CV_32FC4, frame.rgba.data()};
}

/// Means of blocks of `step` pixels. The border goes on beyond the image.
cv::Mat shrunk(const cv::Mat& image, int step) {
  if (step == 1) return image;
  const cv::Size blocks((image.cols + step - 1) / step, (image.rows + step - 1) / step);
  cv::Mat wide, small;
  cv::copyMakeBorder(image, wide, 0, blocks.height * step - image.rows, 0,
                     blocks.width * step - image.cols, cv::BORDER_REPLICATE);
  cv::resize(wide, small, blocks, 0.0, 0.0, cv::INTER_AREA);
  return small;
}

struct Tap {
  int x, y;
  float weight;
};

/// Adds a Gaussian along a line: samples along the nearer axis, linear between two across it.
void addLine(double direction, double sigma, double share, std::vector<Tap>& taps) {
  const double angle_rad = std::numbers::pi * direction / kDirections;
  const double x = std::cos(angle_rad), y = std::sin(angle_rad);
  const bool steep = std::abs(y) > std::abs(x);
  const double slope = steep ? x / y : y / x, length = std::hypot(1.0, slope);
  const int reach = static_cast<int>(std::ceil(3.5 * sigma / length));
  const std::size_t first = taps.size();
  double sum = 0.0;
  for (int along = -reach; along <= reach; ++along) {
    const double weight = std::exp(-0.5 * std::pow(along * length / sigma, 2));
    sum += weight;
    const int below = static_cast<int>(std::floor(along * slope + 1e-6));
    const double above = std::max(along * slope - below, 0.0);
    for (const auto& [across, part] : {std::pair{below, 1.0 - above}, {below + 1, above}}) {
      if (part < 1e-6) continue;
      taps.push_back(
          {steep ? across : along, steep ? along : across, static_cast<float>(weight * part)});
    }
  }
  for (std::size_t i = first; i < taps.size(); ++i) {
    taps[i].weight *= static_cast<float>(share / sum);
  }
}

/// The halo of one direction. Long lines fan out, or a point of light would be a star.
std::vector<Tap> lineOf(int direction, double sigma, bool fans) {
  std::vector<Tap> taps;
  if (!fans) {
    addLine(direction, sigma, 1.0, taps);
    return taps;
  }
  for (const double aside : {-1.0 / 3.0, 0.0, 1.0 / 3.0}) {
    addLine(direction + aside, sigma, 1.0 / 3.0, taps);
  }
  return taps;
}

/// Adds the image, weighted by the taps.
void addSpread(const cv::Mat& image, const std::vector<Tap>& taps, float share, cv::Mat& sum) {
  int reach = 0;
  for (const Tap& tap : taps) reach = std::max({reach, std::abs(tap.x), std::abs(tap.y)});
  cv::Mat wide;
  cv::copyMakeBorder(image, wide, reach, reach, reach, reach, cv::BORDER_REPLICATE);
  parallelFor(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    constexpr int kBlock = 4;  // pixels whose sums stay in registers
    const int y = static_cast<int>(row);
    auto* to = sum.ptr<float>(y);
    for (int x = 0; x < image.cols; x += kBlock) {
      const int first = std::min(x, std::max(image.cols - kBlock, 0));
      const int count = std::min(kBlock, image.cols);
      float block[4 * kBlock] = {};
      for (const Tap& tap : taps) {
        const float* from = wide.ptr<float>(y + reach + tap.y) +
                            4 * static_cast<std::ptrdiff_t>(first + reach + tap.x);
        for (int i = 0; i < 4 * count; ++i) block[i] += tap.weight * from[i];
      }
      for (int i = 4 * (x - first); i < 4 * count; ++i) to[4 * first + i] += share * block[i];
    }
  });
}

}  // namespace

Halos::Halos(float diffraction_px, std::vector<LensPart>& parts) {
  const DiffractionHalo halo = diffractionHalo(diffraction_px);
  shown_ = parts.size() > 1 && halo.inHalos() > 0.0f;
  if (!shown_) return;
  std::ranges::stable_sort(parts, {}, directionOf);
  for (const LensPart& part : parts) all_weight_ += haloWeight(part);
  for (std::size_t i = 0; i < halo.halo_px.size(); ++i) {
    // The core is blurred already.
    double variance_px2 = halo.halo_px[i] * halo.halo_px[i] - halo.core_px * halo.core_px;
    int step = 1;
    while (variance_px2 >= std::pow(2.0 * step * kLeastSigma, 2)) step *= 2;
    // The means of blocks and the linear steps between them have the variances (step^2 - 1) / 12
    // and step^2 / 6.
    if (step > 1) variance_px2 -= (step * step - 1) / 12.0 + step * step / 6.0;
    halos_.push_back(
        {.share = halo.halo_share[i], .sigma_px = std::sqrt(variance_px2) / step, .step_px = step});
  }
}

void Halos::add(const LensPart& part, Frame& frame) {
  const int direction = directionOf(part);
  const bool first = direction != direction_;
  if (first) {
    spreadGroup();
    direction_ = direction;
    group_.resize(frame.size_px);
  }
  addPart(frame, haloWeight(part) / all_weight_, first, group_);
}

void Halos::spreadGroup() {
  if (direction_ < 0) return;
  readFromGpu(group_);
  const cv::Mat image = imageOf(group_);
  for (Halo& halo : halos_) {
    const cv::Mat small = shrunk(image, halo.step_px);
    if (halo.light.rgba.empty()) {
      halo.light.resize({small.cols, small.rows});
      std::ranges::fill(halo.light.rgba, glm::vec4(0.0f));
    }
    cv::Mat light = imageOf(halo.light);
    addSpread(small, lineOf(direction_, halo.sigma_px, halo.step_px > 1), halo.share, light);
  }
}

void Halos::spreadInto(Frame& mean) {
  spreadGroup();
  readFromGpu(mean);
  cv::Mat light = imageOf(mean);
  float in_core = 1.0f;
  for (const Halo& halo : halos_) in_core -= halo.share;
  light *= in_core;
  for (Halo& halo : halos_) {
    const cv::Mat spread = imageOf(halo.light);
    if (halo.step_px == 1) {
      light += spread;
      continue;
    }
    cv::Mat wide;
    cv::resize(spread, wide, spread.size() * halo.step_px, 0.0, 0.0, cv::INTER_LINEAR);
    light += wide(cv::Rect(0, 0, light.cols, light.rows));
  }
}

}  // namespace foci
