// The wavefront as Zernike coefficients: orthonormal polynomials, rescaled coefficients against a
// direct fit, slopes and curvatures against closed forms, and the signs of the observer's axes.
#include "render/optics/wavefront.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace foci {
namespace FOCI_FILE {

constexpr double kPupil_m = 6e-3;

/// Nodes of the disc for polynomials up to degree 20 in r and angle: Gauss-Legendre in r^2 (11
/// nodes, by Newton's method) and 41 equal angles.
template <typename Visit>
void forDisc(const Visit& visit) {
  constexpr int kNodes = 11, kAngles = 41;
  for (int i = 0; i < kNodes; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (kNodes + 0.5)), slope = 0.0;
    for (int step = 0; step < 50; ++step) {
      const double p = std::legendre(kNodes, x);
      slope = kNodes * (x * p - std::legendre(kNodes - 1, x)) / (x * x - 1.0);
      x -= p / slope;
    }
    const double weight = 1.0 / ((1.0 - x * x) * slope * slope);  // of the unit interval
    const double r = std::sqrt(0.5 * (1.0 + x));
    for (int a = 0; a < kAngles; ++a) {
      const double angle_rad = 2.0 * std::numbers::pi * (a + 0.3) / kAngles;
      visit(r * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad)), weight / kAngles);
    }
  }
}

Wavefront oneTerm(int index, double um) {
  Wavefront w{.zernike_um = {}, .pupil_m = kPupil_m};
  w.zernike_um.assign(static_cast<std::size_t>(index) + 1, 0.0);
  w.zernike_um.back() = um;
  return w;
}

/// An eye with every term up to `n`, all different.
Wavefront everyTerm(int n) {
  Wavefront w{.zernike_um = {}, .pupil_m = kPupil_m};
  for (int j = 0; j < zernikeCount(n); ++j) {
    w.zernike_um.push_back(std::sin(1.0 + 2.7 * j) / (1.0 + 0.1 * j));
  }
  return w;
}

TEST(Wavefront, TheSingleIndexFollowsOsa) {
  EXPECT_EQ(zernikeIndex({.n = 2, .m = -2}), 3);
  EXPECT_EQ(zernikeIndex({.n = 2, .m = 0}), 4);
  EXPECT_EQ(zernikeIndex({.n = 3, .m = -3}), 6);
  EXPECT_EQ(zernikeIndex({.n = 4, .m = 0}), 12);
  for (int j = 0; j < 66; ++j) EXPECT_EQ(zernikeIndex(zernikeOrder(j)), j);
}

TEST(Wavefront, PolynomialsAreOrthonormal) {
  std::vector<double> products(66 * 66), values(66);
  forDisc([&](const glm::dvec2& at, double weight) {
    for (int j = 0; j < 66; ++j) values[j] = zernike(zernikeOrder(j), at);
    for (int i = 0; i < 66; ++i) {
      for (int j = 0; j < 66; ++j) products[66 * i + j] += weight * values[i] * values[j];
    }
  });
  for (int i = 0; i < 66; ++i) {
    for (int j = 0; j < 66; ++j) {
      EXPECT_NEAR(products[66 * i + j], i == j ? 1.0 : 0.0, 1e-9) << i << ' ' << j;
    }
  }
}

TEST(Wavefront, RescaledCoefficientsEqualADirectFit) {
  const Wavefront large = everyTerm(10), small = rescaled(large, 3e-3);
  // The smaller pupil's own coefficients: the means of wavefront times polynomial over it.
  std::vector<double> fitted_um(66);
  forDisc([&](const glm::dvec2& at, double weight) {
    double error_um = 0.0;
    for (int j = 0; j < 66; ++j)
      error_um += large.zernike_um[j] * zernike(zernikeOrder(j), 0.5 * at);
    for (int j = 0; j < 66; ++j) fitted_um[j] += weight * error_um * zernike(zernikeOrder(j), at);
  });
  for (int j = 0; j < 66; ++j) EXPECT_NEAR(small.zernike_um[j], fitted_um[j], 1e-6) << j;
  EXPECT_EQ(small.pupil_m, 3e-3);
}

TEST(Wavefront, RescalingThereAndBackChangesNothing) {
  const Wavefront eye = everyTerm(8), again = rescaled(rescaled(eye, 4e-3), kPupil_m);
  for (std::size_t j = 0; j < eye.zernike_um.size(); ++j) {
    EXPECT_NEAR(again.zernike_um[j], eye.zernike_um[j], 1e-9);
  }
}

TEST(Wavefront, DefocusIsACurvatureInDioptres) {
  // M = -4 sqrt(3) c / r^2 corrects the eye (Thibos, Hong, Bradley and Applegate, 2004).
  const double r_mm = 3.0, um = 0.5, too_strong_D = 4.0 * std::sqrt(3.0) * um / (r_mm * r_mm);
  const PupilWavefront eye(oneTerm(4, um));
  for (const glm::dvec2 p : {glm::dvec2(0.0), glm::dvec2(0.3, -0.8)}) {
    const PupilWavefront::At at = eye.at(p);
    EXPECT_NEAR(at.curvature_D[0][0], too_strong_D, 1e-12);
    EXPECT_NEAR(at.curvature_D[1][1], too_strong_D, 1e-12);
    EXPECT_NEAR(at.curvature_D[0][1], 0.0, 1e-12);
    EXPECT_NEAR(at.slope.x, too_strong_D * p.x * 3e-3, 1e-15);
    EXPECT_NEAR(at.slope.y, too_strong_D * p.y * 3e-3, 1e-15);
  }
}

TEST(Wavefront, AstigmatismIsThePowerVectorOfTheFocus) {
  const double per_um = 2.0 * std::sqrt(6.0) / 9.0;
  const glm::dmat2 j0 = PupilWavefront(oneTerm(5, 0.4)).at({0.1, 0.2}).curvature_D;
  EXPECT_NEAR(j0[0][0], 0.4 * per_um, 1e-12);
  EXPECT_NEAR(j0[1][1], -0.4 * per_um, 1e-12);
  const glm::dmat2 j45 = PupilWavefront(oneTerm(3, 0.4)).at({0.1, 0.2}).curvature_D;
  EXPECT_NEAR(j45[0][1], 0.4 * per_um, 1e-12);
  EXPECT_NEAR(j45[1][0], 0.4 * per_um, 1e-12);
  EXPECT_NEAR(j45[0][0], 0.0, 1e-12);
}

TEST(Wavefront, SphericalAberrationGrowsWithTheCubeOfTheRadius) {
  // Z_12 = sqrt(5) (6 r^4 - 6 r^2 + 1), so the slope is sqrt(5) (24 r^3 - 12 r) / radius.
  const PupilWavefront eye(oneTerm(12, 0.2));
  for (const double r : {0.0, 0.25, 0.5, 1.0}) {
    EXPECT_NEAR(eye.at({r, 0.0}).slope.x,
                0.2e-6 * std::sqrt(5.0) * (24.0 * r * r * r - 12.0 * r) / 3e-3, 1e-15);
  }
}

TEST(Wavefront, TheObserverSeesBothAxesReversed) {
  // The image's axes are the aberrometer's turned by 180 degrees: odd orders change their sign.
  const Wavefront eye = everyTerm(6);
  const PupilWavefront seen(eye);
  for (const glm::dvec2 p : {glm::dvec2(0.5, 0.1), glm::dvec2(-0.7, 0.6)}) {
    double expected_um = 0.0;
    for (int j = 3; j < 28; ++j) {
      expected_um += eye.zernike_um[static_cast<std::size_t>(j)] * zernike(zernikeOrder(j), -p);
    }
    EXPECT_NEAR(seen.at(p).error_m, 1e-6 * expected_um, 1e-15);
  }
}

TEST(Wavefront, SlopesAndCurvaturesAreDerivatives) {
  const PupilWavefront eye(everyTerm(10));
  const double step = 1e-5, radius_m = 3e-3;
  for (const glm::dvec2 p : {glm::dvec2(0.2, 0.3), glm::dvec2(-0.5, 0.4), glm::dvec2(0.1, -0.9)}) {
    const PupilWavefront::At at = eye.at(p);
    for (int axis = 0; axis < 2; ++axis) {
      glm::dvec2 to(0.0);
      to[axis] = step;
      const PupilWavefront::At before = eye.at(p - to), after = eye.at(p + to);
      EXPECT_NEAR(at.slope[axis], (after.error_m - before.error_m) / (2.0 * step * radius_m), 1e-9);
      const glm::dvec2 bend = (after.slope - before.slope) / (2.0 * step * radius_m);
      EXPECT_NEAR(at.curvature_D[axis].x, bend.x, 1e-5);
      EXPECT_NEAR(at.curvature_D[axis].y, bend.y, 1e-5);
    }
  }
}

TEST(Wavefront, TiltHasNoEffect) {
  EXPECT_FALSE(Wavefront{});
  EXPECT_FALSE((Wavefront{.zernike_um = {1.0, 1.0, 1.0}, .pupil_m = kPupil_m}));
  EXPECT_TRUE(oneTerm(3, 0.1));
  EXPECT_EQ(PupilWavefront(oneTerm(2, 5.0)).at({0.5, 0.5}).slope, glm::dvec2(0.0));
}

TEST(TypicalWavefront, GrowsWithAgeAsMeasured) {
  EXPECT_NEAR(rms_um(typicalWavefront(40.0), 3), 0.33, 1e-12);
  const double young_um = rms_um(rescaled(typicalWavefront(30.0), 5e-3), 3);
  const double old_um = rms_um(rescaled(typicalWavefront(70.0), 5e-3), 3);
  EXPECT_NEAR(old_um - young_um, 40.0 * 0.0032, 1e-9);
  EXPECT_GT(rms_um(typicalWavefront(18.0), 3), 0.15);
}

TEST(Wavefront, RootMeanSquareIsTheLengthOfTheCoefficients) {
  const Wavefront w{.zernike_um = {9, 9, 9, 0.3, 0.4, 0.0, 1.2}, .pupil_m = kPupil_m};
  EXPECT_NEAR(rms_um(w), 1.3, 1e-12);
  EXPECT_NEAR(rms_um(w, 3), 1.2, 1e-12);
  EXPECT_NEAR(rms_um(withoutRefraction(w)), 1.2, 1e-12);
}

}  // namespace FOCI_FILE
}  // namespace foci
