#include "render/optics/diffraction.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace foci {
namespace {

/// Diffraction below this share of the prefilter's variance is left out.
constexpr double kLeastShare = 0.03;

/// Widths of the halos, in pixels, or in Gaussians of the Airy pattern where these are wider. Of
/// the pairs from 2 to 3 px by 10 to 18 px, (2.5, 14) and (2.75, 15) keep the Airy pattern's
/// moments to 3 % in discs of 4 to 12 px. Out of focus, the first is nearer to Fourier optics.
constexpr std::array<double, 2> kHalo_px{2.5, 14.0};

/// Standard deviation, in lens radii and along an axis, of the distances that go with the
/// frequencies of a Gaussian of `blur_px`: lambda / (2 pi blur) = diffraction / (sqrt(2) blur).
double shiftOf(double diffraction_px, double blur_px) {
  return diffraction_px / (std::numbers::sqrt2 * blur_px);
}

}  // namespace

double diffractionGaussian_rad(double pupil_m, double wavelength_m) {
  return std::numbers::sqrt2 / std::numbers::pi * wavelength_m / pupil_m;
}

double peakLostToDiffraction(double diffraction_px, double blur_px) {
  // Distances of a Gaussian in two dimensions: quantiles of Rayleigh's distribution.
  constexpr int kQuantiles = 128;
  const double shift = shiftOf(diffraction_px, blur_px);
  double lost = 0.0;
  for (int i = 0; i < kQuantiles; ++i) {
    const double s = 0.5 * shift * std::sqrt(-2.0 * std::log(1.0 - (i + 0.5) / kQuantiles));
    const double mtf =
        s >= 1.0 ? 0.0 : 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s));
    lost += (1.0 - mtf) / kQuantiles;
  }
  return lost;
}

float diffractionThroughPixel_px(float diffraction_px) {
  // A Gaussian of variance v takes v / (1 + v) of the peak.
  const double lost = peakLostToDiffraction(diffraction_px, 1.0);
  const double variance_px2 = lost / (1.0 - lost);
  return variance_px2 < kLeastShare ? 0.0f : static_cast<float>(std::sqrt(variance_px2));
}

DiffractionHalo diffractionHalo(float diffraction_px) {
  if (diffractionThroughPixel_px(diffraction_px) == 0.0f) return {};
  const double d2 = double{diffraction_px} * diffraction_px;
  std::array<double, 2> blur2{}, lost{};  // of and through each halo
  for (std::size_t i = 0; i < 2; ++i) {
    blur2[i] = kHalo_px[i] * kHalo_px[i] * (1.0 + d2);
    lost[i] = peakLostToDiffraction(diffraction_px, std::sqrt(blur2[i]));
  }
  // What a Gaussian takes of its peak through a round blur of variance b: of the core, which is
  // round, and of a halo, which is a line. So the shares follow from the core's variance by two
  // linear equations.
  const auto round = [](double v, double b) { return v / (v + b); };
  const auto line = [](double v, double b) { return 1.0 - 1.0 / std::sqrt(1.0 + v / b); };
  const auto sharesOf = [&](double core2) {
    const double near = round(core2, blur2[0]), far = round(core2, blur2[1]);
    const glm::dmat2 halos(line(blur2[0], blur2[0]) - near, line(blur2[0], blur2[1]) - far,
                           line(blur2[1], blur2[0]) - near, line(blur2[1], blur2[1]) - far);
    return glm::inverse(halos) * glm::dvec2(lost[0] - near, lost[1] - far);
  };
  const double lost_near = peakLostToDiffraction(diffraction_px, 1.0);
  double low = 0.0, high = 4.0 * lost_near / (1.0 - lost_near);
  for (int i = 0; i < 40; ++i) {
    const double core2 = 0.5 * (low + high);
    const glm::dvec2 share = sharesOf(core2);
    const double sum = (1.0 - share.x - share.y) * round(core2, 1.0) +
                       share.x * line(blur2[0], 1.0) + share.y * line(blur2[1], 1.0);
    (sum < lost_near ? low : high) = core2;
  }
  const glm::dvec2 share = sharesOf(low);
  return {
      .core_px = static_cast<float>(std::sqrt(low)),
      .halo_px = {static_cast<float>(std::sqrt(blur2[0])), static_cast<float>(std::sqrt(blur2[1]))},
      .halo_share = {static_cast<float>(share.x), static_cast<float>(share.y)}};
}

float DiffractionHalo::coreOfPart_px(double lost) const {
  return static_cast<float>(core_px * std::sqrt(lost));
}

LightInCore::LightInCore(float diffraction_px, const DiffractionHalo& halo)
    : lost_(peakLostToDiffraction(diffraction_px, halo.halo_px[0])) {
  constexpr int kDirections = 32;  // over a quarter turn
  const double shift = shiftOf(diffraction_px, halo.halo_px[0]);
  for (int i = 0; i <= kSteps; ++i) {
    const double r = static_cast<double>(i) / kSteps;
    double lost = 0.0;
    for (int k = 0; k < kDirections; ++k) {
      const double angle_rad = 0.5 * std::numbers::pi * (k + 0.5) / kDirections;
      const double across = r * std::sin(angle_rad);
      const double to_rim = std::sqrt(1.0 - across * across) - r * std::cos(angle_rad);
      lost += std::exp(-2.0 * to_rim * to_rim / (shift * shift)) / kDirections;
    }
    by_radius_[static_cast<std::size_t>(i)] = 1.0 - lost;
  }
}

double LightInCore::at(double radius) const {
  const double place = std::clamp(radius, 0.0, 1.0) * kSteps;
  const auto below = std::min(static_cast<std::size_t>(place), std::size_t{kSteps - 1});
  const double t = place - static_cast<double>(below);
  return (1.0 - t) * by_radius_[below] + t * by_radius_[below + 1];
}

}  // namespace foci
