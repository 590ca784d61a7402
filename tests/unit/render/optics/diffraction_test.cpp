// Diffraction as Gaussians, against the Airy pattern itself.
#include "render/optics/pupil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace foci {
namespace FOCI_FILE {

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

TEST(Diffraction, CoreAndHalosTakeAsMuchThroughAPixelAndThroughEachHalo) {
  for (const float diffraction_px : {0.1f, 0.15f, 0.3f, 1.0f, 3.0f, 10.0f}) {
    const DiffractionHalo halo = diffractionHalo(diffraction_px);
    const auto round = [](double variance, double blur2) { return blur2 / (blur2 + variance); };
    const auto line = [&](double variance, double b) { return std::sqrt(round(variance, b)); };
    for (const double blur2 : {1.0, std::pow(halo.halo_px[0], 2), std::pow(halo.halo_px[1], 2)}) {
      double peak = (1.0 - halo.inHalos()) * round(std::pow(halo.core_px, 2), blur2);
      for (std::size_t i = 0; i < 2; ++i) {
        peak += halo.halo_share[i] * line(std::pow(halo.halo_px[i], 2), blur2);
      }
      EXPECT_NEAR(peak, 1.0 - peakLostToDiffraction(diffraction_px, std::sqrt(blur2)), 1e-5)
          << diffraction_px << ' ' << blur2;
    }
    EXPECT_GT(halo.halo_share[0], 0.0f) << diffraction_px;
    EXPECT_GT(halo.halo_share[1], 0.0f) << diffraction_px;
    EXPECT_LT(halo.inHalos(), 0.35f) << diffraction_px;
  }
  EXPECT_EQ(diffractionHalo(0.0f).inHalos(), 0.0f);
}

/// Light and variance along an axis, within a disc, of what a density spreads through a pixel: a
/// Gaussian of 1 px.
double varianceWithin(double radius_px, double diffraction_px, bool airy) {
  const DiffractionHalo halo = diffractionHalo(static_cast<float>(diffraction_px));
  // The mean over all directions of a Gaussian with these variances along and across a line.
  const auto gaussian = [](double along, double across, double r_px) {
    const double square = 0.25 * r_px * r_px, sum = 1.0 / along + 1.0 / across;
    return std::exp(-square * sum) * std::cyl_bessel_i(0.0, square * (1.0 / across - 1.0 / along)) /
           (2.0 * std::numbers::pi * std::sqrt(along * across));
  };
  // Through the pixel by Hankel's transform: MTF of the pupil times that of the pixel.
  const auto density = [&](double r_px) {
    if (!airy) {
      const double core = 1.0 + std::pow(halo.core_px, 2);
      double sum = (1.0 - halo.inHalos()) * gaussian(core, core, r_px);
      for (std::size_t i = 0; i < 2; ++i) {
        sum += halo.halo_share[i] * gaussian(1.0 + std::pow(halo.halo_px[i], 2), 1.0, r_px);
      }
      return sum;
    }
    // s: frequency over the pupil's cutoff, sqrt(2) / (pi diffraction_px) cycles a pixel.
    const double cutoff = std::numbers::sqrt2 / (std::numbers::pi * diffraction_px);
    const double end = std::min(1.0, 1.0 / cutoff), step = end / 600;
    double sum = 0.0;
    for (double s = 0.5 * step; s < end; s += step) {
      const double u = 2.0 * std::numbers::pi * s * cutoff;  // rad a pixel
      const double mtf = 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s));
      sum += mtf * std::exp(-0.5 * u * u) * std::cyl_bessel_j(0.0, u * r_px) * s * step;
    }
    return 2.0 * std::numbers::pi * cutoff * cutoff * sum;
  };
  double light = 0.0, squares = 0.0;
  constexpr double kStep_px = 0.05;
  for (double r_px = 0.5 * kStep_px; r_px < radius_px; r_px += kStep_px) {
    const double ring = density(r_px) * r_px * kStep_px;
    light += ring;
    squares += 0.5 * ring * r_px * r_px;
  }
  return squares / light;
}

// Pixels of 1 arcmin, pupils of 2, 3 and 6 mm.
TEST(Diffraction, CoreAndHalosHaveTheMomentsOfTheAiryPatternWithinADisc) {
  for (const double diffraction_px : {0.43, 0.286, 0.143}) {
    for (const double radius_px : {4.0, 5.0, 6.0, 8.0, 12.0}) {
      EXPECT_NEAR(varianceWithin(radius_px, diffraction_px, false) /
                      varianceWithin(radius_px, diffraction_px, true),
                  1.0, 0.03)
          << diffraction_px << ' ' << radius_px;
    }
  }
}

TEST(Diffraction, TheRimLosesTheLightOfTheHalo) {
  for (const float diffraction_px : {0.1f, 0.3f, 0.8f}) {
    const LightInCore core(diffraction_px, diffractionHalo(diffraction_px));
    double mean = 0.0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) mean += core.at(std::sqrt((i + 0.5) / kSteps)) / kSteps;
    EXPECT_NEAR(mean, 1.0 - core.lost(), 0.003) << diffraction_px;
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

}  // namespace FOCI_FILE
}  // namespace foci
