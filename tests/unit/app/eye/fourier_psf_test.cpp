// Fourier optics against closed forms: the Airy pattern, the MTF of a round pupil, Marechal's
// Strehl ratio, the blur disc; and the signs against the rays.
#include "app/eye/visual_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

#include "base/text.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kWave_m = 555e-9;

EyeOptics eye(double pupil_m, double defocus_D = 0.0, std::vector<double> zernike_um = {}) {
  EyeOptics optics{.pupil = {.diameter_m = pupil_m}, .defocus_D = defocus_D};
  optics.pupil.wavefront =
      rescaled({.zernike_um = std::move(zernike_um), .pupil_m = 6e-3}, pupil_m);
  return optics;
}

/// `fourierPsf` as seen through the pixels of foci: spread by the bell (1 - r^2 / (8 sigma^2))^2,
/// of the standard deviation `sigma_px` along each axis (docs/formulas.md, section 3), and taken at
/// the middles of pixels of `pixel_rad`.
Psf psfThroughPixels(const EyeOptics& optics, double pixel_rad, double sigma_px, int size) {
  constexpr double kDenser = 2.5;    // than light of a coherent pupil needs, lambda / A
  constexpr double kPerPixel = 5.0;  // samples of the bell's standard deviation
  const double radius_px = std::sqrt(8.0) * sigma_px;
  int finer = static_cast<int>(
      std::ceil(pixel_rad * kDenser * optics.pupil.diameter_m / optics.wavelength_m));
  finer = std::max(finer, static_cast<int>(std::ceil(kPerPixel / sigma_px)));
  finer += 1 - finer % 2;
  const int reach = static_cast<int>(std::ceil(radius_px * finer));
  const int margin = 2 * ((reach + finer - 1) / finer);
  const Psf fine = fourierPsf(optics, pixel_rad / finer, (size + margin) * finer);
  cv::Mat bell = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_64F);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double t = 1.0 - (x * x + y * y) / std::pow(radius_px * finer, 2);
      if (t > 0.0) bell.at<double>(y + reach, x + reach) = t * t;
    }
  }
  bell *= static_cast<double>(finer) * finer /
          cv::sum(bell)[0];  // density of light, times the pixel's area
  const cv::Mat light(fine.size, fine.size, CV_64F, const_cast<double*>(fine.light.data()));
  Psf seen{.size = size, .sample_rad = pixel_rad};
  seen.light.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const int x = fine.size / 2 + (column - size / 2) * finer - reach;
      const int y = fine.size / 2 + (row - size / 2) * finer - reach;
      seen.light.push_back(light(cv::Rect(x, y, bell.cols, bell.rows)).dot(bell));
    }
  }
  return seen;
}

struct Moments {
  double light = 0.0;
  glm::dvec2 mean_rad{0.0}, variance_rad2{0.0};
};

/// Of the samples within `radius` samples of the middle. The rings of diffraction have no finite
/// second moment: their light falls with the cube of the angle.
Moments momentsOf(const Psf& psf, double radius = std::numeric_limits<double>::infinity()) {
  Moments m;
  glm::dvec2 squares(0.0);
  const int middle = psf.size / 2;
  for (int row = 0; row < psf.size; ++row) {
    for (int column = 0; column < psf.size; ++column) {
      if (std::hypot(column - middle, row - middle) > radius) continue;
      const double light = psf.at(column, row);
      const glm::dvec2 at = psf.sample_rad * glm::dvec2(column - middle, row - middle);
      m.light += light;
      m.mean_rad += light * at;
      squares += light * at * at;
    }
  }
  m.mean_rad /= m.light;
  m.variance_rad2 = squares / m.light - m.mean_rad * m.mean_rad;
  return m;
}

/// Of the ray of the pupil that lies farthest from the middle, rad.
double farthestRay_rad(const EyeOptics& optics) {
  const PupilWavefront wavefront(optics.pupil.wavefront);
  double farthest = 0.0;
  constexpr int kRays = 2000;
  for (int i = 0; i < kRays; ++i) {
    const glm::dvec2 p(lensSample(i, kRays));
    farthest = std::max(
        farthest,
        glm::length(wavefront.at(p).slope + optics.defocus_D * 0.5 * optics.pupil.diameter_m * p));
  }
  return farthest;
}

TEST(FourierPsf, IsTheAiryPattern) {
  for (const double pupil_m : {2e-3, 3e-3, 6e-3}) {
    const double sample_rad = 0.02 * kArcmin_rad;
    const Psf psf = fourierPsf(eye(pupil_m), sample_rad, 201);
    // Light of the Airy pattern: pi A^2 / (4 lambda^2) (2 J1(v) / v)^2, v = pi A t / lambda.
    const double peak =
        std::numbers::pi * pupil_m * pupil_m / (4.0 * kWave_m * kWave_m) * sample_rad * sample_rad;
    for (int column = 0; column < 201; ++column) {
      const double v = std::numbers::pi * pupil_m * std::abs(column - 100) * sample_rad / kWave_m;
      const double airy = v == 0.0 ? 1.0 : std::pow(2.0 * std::cyl_bessel_j(1.0, v) / v, 2);
      EXPECT_NEAR(psf.at(column, 100) / peak, airy, 0.01) << pupil_m << ' ' << v;
    }
  }
}

TEST(FourierPsf, KeepsTheLight) {
  for (const double defocus_D : {0.0, -1.0, 1.0}) {
    const Psf psf = fourierPsf(eye(6e-3, defocus_D), kArcmin_rad, 257);
    EXPECT_NEAR(momentsOf(psf).light, 1.0, 1e-3) << defocus_D;
  }
}

TEST(FourierPsf, FarOutOfFocusIsTheBlurDisc) {
  const Psf psf = fourierPsf(eye(4e-3, 2.0), 0.5 * kArcmin_rad, 121);
  const double radius_rad = 2e-3 * 2.0;
  double inside = 0.0, middle = 0.0;
  for (int row = 0; row < 121; ++row) {
    for (int column = 0; column < 121; ++column) {
      const double r_rad = std::hypot(column - 60, row - 60) * psf.sample_rad;
      const double light = psf.at(column, row);
      if (r_rad <= 1.1 * radius_rad) inside += light;
      if (r_rad <= 0.5 * radius_rad) middle += light;
    }
  }
  EXPECT_NEAR(middle, 0.25, 0.01);
  EXPECT_NEAR(inside, 1.0, 0.04);  // the rim of the pupil diffracts
}

TEST(FourierPsf, LightGoesWhereTheRaysGo) {
  // Coma, trefoil and spherical aberration out of focus: the means of the ray slopes.
  const std::vector<double> terms{0, 0, 0, 0, 0, 0, -0.3, 0.4, 0.2, 0, 0, 0, 0.2};
  for (const double defocus_D : {-0.5, 0.5}) {
    const EyeOptics optics = eye(6e-3, defocus_D, terms);
    const PupilWavefront wavefront(optics.pupil.wavefront);
    glm::dvec2 mean(0.0), square(0.0);
    constexpr int kRays = 20000;
    for (int i = 0; i < kRays; ++i) {
      const glm::dvec2 p(lensSample(i, kRays));
      const glm::dvec2 slope = wavefront.at(p).slope + defocus_D * 3e-3 * p;
      mean += slope / double{kRays};
      square += slope * slope / double{kRays};
    }
    const Psf psf = fourierPsf(optics, 0.5 * kArcmin_rad, 241);
    const Moments all = momentsOf(psf);
    EXPECT_NEAR(all.mean_rad.x, mean.x, 0.03 * std::sqrt(square.x));
    EXPECT_NEAR(all.mean_rad.y, mean.y, 0.03 * std::sqrt(square.y));
  }
}

TEST(FourierPsf, ThroughPixelsIsSpreadByTheirBell) {
  const Psf psf = psfThroughPixels(eye(6e-3, 1.0), kArcmin_rad, 1.0, 81);
  const double expected_rad2 = std::pow(3e-3 * 1.0, 2) / 4.0 + kArcmin_rad * kArcmin_rad;
  EXPECT_NEAR(momentsOf(psf).light, 1.0, 2e-3);
  EXPECT_NEAR(momentsOf(psf, 13.0).variance_rad2.x / expected_rad2, 1.0, 0.03);
}

TEST(RadialMtf, OfARoundPupilIsTheClosedForm) {
  const std::vector<double> u{0.0, 5.0, 10.0, 20.0, 40.0, 60.0, 100.0};
  const std::vector<double> mtf = radialMtf(eye(3e-3), u);
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_NEAR(mtf[i], diffractionMtf(3e-3, kWave_m, u[i]), 0.005) << u[i];
  }
}

TEST(StrehlRatio, FollowsMarechalForSmallErrors) {
  EXPECT_NEAR(strehlRatio(eye(6e-3)), 1.0, 1e-6);
  for (const std::size_t term : {std::size_t{5}, std::size_t{8}, std::size_t{12}}) {
    std::vector<double> terms(term + 1);
    terms[term] = 0.03;
    const double phase = 2.0 * std::numbers::pi * 0.03e-6 / kWave_m;
    EXPECT_NEAR(strehlRatio(eye(6e-3, 0.0, terms)), std::exp(-phase * phase), 0.01) << term;
  }
}

/// The typical eye of the goals: coma, trefoil and spherical aberration of 6 mm.
const std::vector<double> kTypical{0, 0, 0, 0, 0, 0, -0.11, 0.14, 0.02, 0.01, 0, 0, 0.13, -0.03};

struct Comparison {
  double light = 0.0;
  glm::dvec2 variance_ratio{0.0};
  double rms = 0.0;      ///< over the window, of the peak
  double rms_lit = 0.0;  ///< over the pixels of at least 1 % of the peak
};

/// A point of light by the renderer against Fourier optics, both through pixels of 1 arcmin.
Comparison compareSplatted(double pupil_m, double defocus_D, const std::string& method) {
  constexpr int kSize_px = 65;
  constexpr float kFocal_px = static_cast<float>(1.0 / kArcmin_rad);
  EyeOptics optics = eye(pupil_m, defocus_D, kTypical);
  optics.pupil.wavefront = withoutRefraction(optics.pupil.wavefront);
  const Psf truth = psfThroughPixels(optics, kArcmin_rad, 1.0, kSize_px);

  SurfelCloud cloud;
  appendSurfel(cloud, {0.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 1.0f}, 3e-6f, 4e-11f, glm::vec3(1.0f));
  RenderSettings settings;
  settings.defocus =
      defocusOfLens(pupil_m, glm::vec2(kFocal_px), 1.0 + defocus_D, DistanceAlong::axis);
  settings.pupil = optics.pupil;
  settings.pupil.diffraction_px =
      static_cast<float>(diffractionGaussian_rad(pupil_m, kWave_m) * kFocal_px);
  // The light in the middle of the middle pixel, as in the truth.
  View view{.size_px = {kSize_px, kSize_px},
            .focal_px = glm::vec2(kFocal_px),
            .principal_px = glm::vec2(0.5f * kSize_px)};
  Frame frame;
  makeMethod(method, cloud)->render(view, settings, frame);
  double light = 0.0;
  for (const glm::vec4& p : frame.rgba) light += p.r;
  Psf splatted{.size = kSize_px, .sample_rad = kArcmin_rad};
  const double peak = *std::max_element(truth.light.begin(), truth.light.end());
  double squares = 0.0, lit_squares = 0.0;
  int lit = 0;
  for (int row = 0; row < kSize_px; ++row) {
    for (int column = 0; column < kSize_px; ++column) {
      const double seen = frame.at(column, row).r / light;
      splatted.light.push_back(seen);
      const double expected = truth.at(column, row), off = (seen - expected) / peak;
      squares += off * off;
      if (std::max(seen, expected) < 0.01 * peak) continue;
      lit_squares += off * off;
      ++lit;
    }
  }
  // All rays, as far as the pixel's bell of sqrt(8) px spreads them.
  const double window_px = farthestRay_rad(optics) / kArcmin_rad + std::sqrt(8.0);
  const Moments a = momentsOf(splatted, window_px), b = momentsOf(truth, window_px);
  return {.light = momentsOf(truth).light,
          .variance_ratio = a.variance_rad2 / b.variance_rad2,
          .rms = std::sqrt(squares / (kSize_px * kSize_px)),
          .rms_lit = std::sqrt(lit_squares / lit)};
}

// 19 sub-apertures, each with a core and two halos, all of them Gaussian. docs/results.md has the
// figures.
TEST(SplattedPsf, IsThatOfFourierOptics) {
  for (const double pupil_m : {3e-3, 6e-3}) {
    for (const double defocus_D : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const Comparison c = compareSplatted(pupil_m, defocus_D, "sweep:19");
      const std::string where = std::to_string(pupil_m) + " m, " + std::to_string(defocus_D) + " D";
      RecordProperty("psf_" + std::to_string(static_cast<int>(1e3 * pupil_m)) + " mm, " +
                         significant(defocus_D) + " D",
                     decimal(100.0 * c.rms, 2) + " " + decimal(100.0 * c.rms_lit, 2) + " " +
                         decimal(100.0 * (c.variance_ratio.x - 1.0), 1) + " " +
                         decimal(100.0 * (c.variance_ratio.y - 1.0), 1));
      EXPECT_NEAR(c.light, 1.0, 3e-3) << where;  // of the truth, in the window
      EXPECT_LT(c.rms, 0.011) << where;
      EXPECT_LT(c.rms_lit, 0.031) << where;
      EXPECT_NEAR(c.variance_ratio.x, 1.0, 0.03) << where;
      EXPECT_NEAR(c.variance_ratio.y, 1.0, 0.03) << where;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
