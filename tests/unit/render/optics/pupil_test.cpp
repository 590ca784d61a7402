// The lens in parts: their light, their second moments and their signs, against sums over the whole
// pupil.
#include "render/optics/pupil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/methods/lens_samples.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kPupil_m = 6e-3;
constexpr float kFocal_px = 3438.0f;  // 60 px for each degree

/// Coma, trefoil and spherical aberration of a typical eye, at 6 mm.
Pupil typicalEye() {
  Pupil pupil{.diameter_m = kPupil_m};
  pupil.wavefront = {.zernike_um = std::vector<double>(13), .pupil_m = kPupil_m};
  pupil.wavefront.zernike_um[6] = -0.11;
  pupil.wavefront.zernike_um[7] = 0.14;
  pupil.wavefront.zernike_um[12] = 0.13;
  return pupil;
}

Defocus lensOf(const Pupil& pupil, double focus_D) {
  return defocusOfLens(pupil.diameter_m, glm::vec2(kFocal_px), focus_D, DistanceAlong::axis);
}

/// Where the lens point `p` of a part shows a point at `point_D`, px.
glm::dvec2 displaced_px(const LensPart& part, const glm::dvec2& p, double point_D) {
  const double m = part.defocus.focus_D - point_D;
  const glm::dvec2 j(part.defocus.astigmatism_D);
  return glm::dvec2(part.shift_px) +
         glm::dvec2(part.defocus.radius_px_per_D) *
             glm::dvec2((m + j.x) * p.x + j.y * p.y, j.y * p.x + (m - j.x) * p.y);
}

struct Moments2 {
  glm::dvec2 mean{0.0};
  double xx = 0.0, xy = 0.0, yy = 0.0;

  void add(const glm::dvec2& at, double weight) {
    mean += weight * at;
    xx += weight * at.x * at.x;
    xy += weight * at.x * at.y;
    yy += weight * at.y * at.y;
  }
};

TEST(LensParts, EqualPartsOfAPlainLens) {
  const Defocus defocus{.radius_px_per_D = glm::vec2(5.0f), .focus_D = 2.0f};
  const std::vector<LensPart> parts = lensParts(defocus, {.diameter_m = kPupil_m}, 7);
  ASSERT_EQ(parts.size(), 7u);
  for (const LensPart& part : parts) {
    EXPECT_EQ(part.defocus, defocus);
    EXPECT_EQ(part.shift_px, glm::vec2(0.0f));
    EXPECT_NEAR(part.weight, 1.0f / 7.0f, 0.02f);
    EXPECT_EQ(part.rest_px, 0.0f);
  }
}

TEST(LensParts, OnePartOfTheSecondOrderIsALensOfThatFocus) {
  Pupil pupil{.diameter_m = kPupil_m};
  pupil.wavefront = withPower({.zernike_um = {}, .pupil_m = kPupil_m}, {0.75, 0.5, -0.25});
  const std::vector<LensPart> parts = lensParts(lensOf(pupil, 1.0), pupil, 1);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_NEAR(parts[0].defocus.focus_D, 1.75, 1e-5);
  EXPECT_NEAR(parts[0].defocus.astigmatism_D.x, 0.5, 1e-5);
  EXPECT_NEAR(parts[0].defocus.astigmatism_D.y, -0.25, 1e-5);
  EXPECT_NEAR(glm::length(parts[0].shift_px), 0.0, 1e-3);
  EXPECT_LT(parts[0].rest_px, 0.2f);  // the blur's own radius is 8 px
}

TEST(LensParts, KeepTheSecondMomentsOfTheRays) {
  const Pupil pupil = typicalEye();
  const PupilWavefront wavefront(pupil.wavefront);
  for (const double point_D : {-1.0, 0.0, 0.5}) {
    Moments2 rays;
    constexpr int kRays = 20000;
    for (int i = 0; i < kRays; ++i) {
      const glm::dvec2 p(lensSample(i, kRays));
      rays.add(double{kFocal_px} * (wavefront.at(p).slope - 0.5 * kPupil_m * point_D * p),
               1.0 / kRays);
    }
    for (const int n : {7, 19, 37}) {
      Moments2 sum;
      for (const LensPart& part : lensParts(lensOf(pupil, 0.0), pupil, n)) {
        // Five points with the mean and the variance of the part's disc, 1/4 of its radius^2.
        const double reach = std::sqrt(0.5) * part.radius;
        for (const glm::dvec2 to : {glm::dvec2(reach, 0), glm::dvec2(-reach, 0),
                                    glm::dvec2(0, reach), glm::dvec2(0, -reach)}) {
          sum.add(displaced_px(part, glm::dvec2(part.centre) + to, point_D), 0.25 * part.weight);
        }
        sum.xx += part.weight * part.rest_px * part.rest_px;
        sum.yy += part.weight * part.rest_px * part.rest_px;
      }
      const double size = rays.xx + rays.yy, share = n == 7 ? 0.06 : 0.03;
      EXPECT_NEAR(sum.xx, rays.xx, share * size) << n << ' ' << point_D;
      EXPECT_NEAR(sum.yy, rays.yy, share * size) << n << ' ' << point_D;
      EXPECT_NEAR(sum.xy, rays.xy, share * size) << n << ' ' << point_D;
      EXPECT_NEAR(sum.xx + sum.yy, size, 0.01 * size) << n << ' ' << point_D;
      EXPECT_NEAR(glm::distance(sum.mean, rays.mean), 0.0, share * std::sqrt(size)) << n;
    }
  }
}

TEST(LensParts, PointsSeeTheSlopeItself) {
  const Pupil pupil = typicalEye();
  const std::vector<glm::vec2> points = {{0.0f, 0.0f}, {0.5f, -0.2f}, {-0.1f, 0.9f}};
  const std::vector<LensPart> parts = lensPoints(lensOf(pupil, 0.0), pupil, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 expected =
        double{kFocal_px} * PupilWavefront(pupil.wavefront).at(points[i]).slope;
    EXPECT_NEAR(parts[i].shift_px.x, expected.x, 1e-4);
    EXPECT_NEAR(parts[i].shift_px.y, expected.y, 1e-4);
  }
}

TEST(LensParts, StilesCrawfordWeighsTheRimLess) {
  Pupil pupil{.diameter_m = kPupil_m, .stiles_crawford_per_mm2 = kStilesCrawford_per_mm2};
  const std::vector<glm::vec2> points = {{0.0f, 0.0f}, {1.0f, 0.0f}};
  std::vector<LensPart> parts = lensPoints(lensOf(pupil, 0.0), pupil, points);
  EXPECT_NEAR(parts[0].weight + parts[1].weight, 1.0, 1e-6);
  EXPECT_NEAR(parts[1].weight / parts[0].weight, std::pow(10.0, -0.041 * 9.0), 1e-6);
  // Most of the light where the centre of the effect lies.
  pupil.stiles_crawford_center_m = {1.5e-3, 0.0};
  parts = lensPoints(lensOf(pupil, 0.0), pupil, points);
  EXPECT_NEAR(parts[0].weight, parts[1].weight, 1e-6);
}

TEST(LensParts, DiffractionTakesLightFromTheRimIntoHalos) {
  Pupil pupil{.diameter_m = kPupil_m, .diffraction_px = 0.3f};
  const DiffractionHalo halo = diffractionHalo(pupil.diffraction_px);
  const std::vector<LensPart> parts = lensParts(lensOf(pupil, 0.0), pupil, 19);
  ASSERT_EQ(parts.size(), 19u);
  float light = 0.0f, middle = 0.0f, rim = 0.0f, core_px2 = 0.0f;
  for (const LensPart& part : parts) {
    light += part.weight;
    const bool inside = glm::length(part.centre) < 0.6f;
    EXPECT_EQ(part.diffraction_px < halo.core_px, inside);
    (inside ? middle : rim) += part.weight;
    core_px2 += part.diffraction_px * part.diffraction_px / 19.0f;
  }
  EXPECT_NEAR(core_px2, halo.core_px * halo.core_px, 0.01f * halo.core_px * halo.core_px);
  EXPECT_NEAR(light, 1.0f, 1e-5f);
  EXPECT_LT(rim / 12.0f, 0.97f * middle / 7.0f);
  EXPECT_EQ(lensParts(lensOf(pupil, 0.0), withoutDiffraction(pupil), 19).size(), 19u);
}

}  // namespace FOCI_FILE
}  // namespace foci
