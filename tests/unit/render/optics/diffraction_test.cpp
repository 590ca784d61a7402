// Diffraction as Gaussians, against the Airy pattern itself.
#include "render/optics/diffraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/optics/pupil.h"

namespace foci {
namespace {

/// The share of the peak that stays: the Airy pattern (2 J1(v) / v)^2 / (2 pi s^2), v = sqrt(2) t /
/// s, summed under a Gaussian of `blur_px`.
double peakOfAiry(double diffraction_px, double blur_px) {
  const double s = diffraction_px, step_px = 0.005 * std::min(s, blur_px);
  double sum = 0.0;
  for (double t = 0.5 * step_px; t < 6.0 * blur_px; t += step_px) {
    const double v = std::numbers::sqrt2 * t / s, airy = 2.0 * std::cyl_bessel_j(1.0, v) / v;
    sum += airy * airy / (s * s) * std::exp(-0.5 * t * t / (blur_px * blur_px)) * t * step_px;
  }
  return sum;
}

TEST(Diffraction, TheGaussianHasThePeakAndTheLightOfTheAiryPattern) {
  // The Airy pattern's peak is pi A^2 / (4 lambda^2) for light of 1; a Gaussian's 1 / (2 pi s^2).
  const double sigma_rad = diffractionGaussian_rad(3e-3, 555e-9);
  const double airy = std::numbers::pi * 3e-3 * 3e-3 / (4.0 * 555e-9 * 555e-9);
  EXPECT_NEAR(1.0 / (2.0 * std::numbers::pi * sigma_rad * sigma_rad) / airy, 1.0, 1e-12);
}

TEST(Diffraction, ThePeakThroughAPixelIsThatOfTheAiryPattern) {
  for (const double diffraction_px : {0.05, 0.15, 0.3, 1.0, 3.0}) {
    for (const double blur_px : {1.0, 3.0}) {
      EXPECT_NEAR(1.0 - peakLostToDiffraction(diffraction_px, blur_px),
                  peakOfAiry(diffraction_px, blur_px), 0.002)
          << diffraction_px << ' ' << blur_px;
    }
  }
}

TEST(Diffraction, OneGaussianTakesAsMuchOfThePeak) {
  for (const float diffraction_px : {0.15f, 0.3f, 1.0f, 3.0f}) {
    const double variance = std::pow(diffractionThroughPixel_px(diffraction_px), 2);
    EXPECT_NEAR(1.0 / (1.0 + variance), peakOfAiry(diffraction_px, 1.0), 0.002) << diffraction_px;
  }
  // Far finer pixels than the pattern see its own peak.
  EXPECT_NEAR(diffractionThroughPixel_px(10.0f) / 10.0, 1.0, 0.02);
  EXPECT_EQ(diffractionThroughPixel_px(0.03f), 0.0f);
  EXPECT_EQ(diffractionThroughPixel_px(0.0f), 0.0f);
}

TEST(Diffraction, CoreAndHaloTakeAsMuchThroughAPixelAndThroughTheHalo) {
  for (const float diffraction_px : {0.1f, 0.15f, 0.3f, 1.0f, 3.0f, 10.0f}) {
    const DiffractionHalo halo = diffractionHalo(diffraction_px);
    const double core2 = std::pow(halo.core_px, 2), halo2 = std::pow(halo.halo_px, 2);
    for (const double blur2 : {1.0, halo2}) {
      const double peak = (1.0 - halo.halo_share) * blur2 / (blur2 + core2) +
                          halo.halo_share * blur2 / (blur2 + halo2);
      EXPECT_NEAR(peak, 1.0 - peakLostToDiffraction(diffraction_px, std::sqrt(blur2)), 1e-5)
          << diffraction_px << ' ' << blur2;
    }
    EXPECT_GT(halo.halo_share, 0.0f);
    EXPECT_LT(halo.halo_share, 0.3f);
  }
  EXPECT_EQ(diffractionHalo(0.0f).halo_share, 0.0f);
}

TEST(Diffraction, TheRimLosesTheLightOfTheHalo) {
  for (const float diffraction_px : {0.1f, 0.3f, 0.8f}) {
    const float share = diffractionHalo(diffraction_px).halo_share;
    const LightInCore core(diffraction_px, share);
    double mean = 0.0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) mean += core.at(std::sqrt((i + 0.5) / kSteps)) / kSteps;
    EXPECT_NEAR(mean, 1.0 - share, 0.003) << diffraction_px;
    EXPECT_LT(core.at(1.0), core.at(0.9));
    EXPECT_GE(core.at(0.0), core.at(0.9));
  }
}

TEST(Diffraction, WidensThePrefilterOnlyWhereItShows) {
  EXPECT_EQ(widened({}, Pupil{.diffraction_px = 0.03f}), Acuity{});
  const float sigma_px = diffractionThroughPixel_px(0.75f);
  EXPECT_NEAR(widened({}, Pupil{.diffraction_px = 0.75f}).base_px, std::hypot(1.0f, sigma_px),
              1e-6f);
  EXPECT_NEAR(widened({}, LensPart{.rest_px = 0.3f, .diffraction_px = 0.4f}).base_px,
              std::sqrt(1.25f), 1e-6f);
}

}  // namespace
}  // namespace foci
