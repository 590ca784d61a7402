// Aberrations over the visual field: the fit, the typical eye, and the lens in each direction.
#include "render/optics/eye_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/optics/lens_field.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kFitTolerance = 1e-6;  // solver floor

/// Coefficients 3 to 8 of an eye whose defocus is quadratic and whose coma is linear in the angle.
std::array<double, 6> madeUp_um(const glm::dvec2& at, int eye) {
  const glm::dvec2 u = at / kFieldUnit_deg;
  return {0.3 * u.x * u.y, 0.5 * eye + 0.2 * u.x - 0.7 * u.y * u.y,
          0.4 * u.x * u.x, 0.0,
          -0.2 * u.y,      0.25 * u.x};
}

std::vector<FieldSample> madeUpEyes() {
  std::vector<FieldSample> samples;
  for (int eye = 0; eye < 3; ++eye) {
    for (int i = -5; i <= 5; ++i) {
      for (int k = -4; k <= 4; ++k) {
        const glm::dvec2 at(8.0 * i, 6.25 * k);  // none but the fovea within 5 degrees
        samples.push_back({eye, at, madeUp_um(at, eye)});
      }
    }
  }
  return samples;
}

TEST(FitField, FindsPolynomialsRelativeToTheFovea) {
  FieldAberrations field;
  ASSERT_TRUE(fitField(madeUpEyes(), field));
  const LocalAberration at = field.at({20.0, -10.0}, false);  // 20 deg temporal, 10 superior
  const std::array<double, 6> z = madeUp_um({20.0, 10.0}, 0);
  EXPECT_NEAR(at.power_D.x, std::sqrt(3.0) * z[1], kFitTolerance);
  EXPECT_NEAR(at.power_D.y, 0.5 * std::sqrt(6.0) * z[2], kFitTolerance);
  EXPECT_NEAR(at.power_D.z, 0.5 * std::sqrt(6.0) * z[0], kFitTolerance);
  EXPECT_NEAR(at.coma_um.x, -z[5], kFitTolerance);
  EXPECT_NEAR(at.coma_um.y, -z[4], kFitTolerance);
}

TEST(FitField, BearsOutliersOfAnEyeAndTheOpticDisc) {
  std::vector<FieldSample> samples = madeUpEyes();
  for (FieldSample& each : samples) {
    const bool on_disc = each.field_deg == glm::dvec2(16.0, 0.0);
    if (on_disc || (each.eye == 1 && each.field_deg.y == 18.75)) each.z_um.fill(9.0);
  }
  FieldAberrations field, clean;
  ASSERT_TRUE(fitField(samples, field) && fitField(madeUpEyes(), clean));
  for (std::size_t i = 0; i < field.power_D.size(); ++i) {
    EXPECT_NEAR(field.power_D[i], clean.power_D[i], kFitTolerance) << i;
  }
}

TEST(FitField, RefusesOneLineOfAngles) {
  std::vector<FieldSample> samples = madeUpEyes();
  std::erase_if(samples, [](const FieldSample& each) { return each.field_deg.y != 0.0; });
  FieldAberrations field;
  EXPECT_FALSE(fitField(samples, field));
}

TEST(TypicalField, AddsNothingAtTheFoveaAndIsMirroredInTheLeftEye) {
  const FieldAberrations& eye = typicalField();
  EXPECT_EQ(eye.at({0.0, 0.0}, false).power_D, glm::dvec3(0.0));
  const LocalAberration right = eye.at({17.0, 8.0}, false), left = eye.at({-17.0, 8.0}, true);
  EXPECT_EQ(left.power_D.x, right.power_D.x);
  EXPECT_EQ(left.power_D.y, right.power_D.y);
  EXPECT_EQ(left.power_D.z, -right.power_D.z);
  EXPECT_EQ(left.coma_um.x, -right.coma_um.x);
  EXPECT_EQ(left.coma_um.y, right.coma_um.y);
}

TEST(TypicalField, IsStrongerAlongTheRadius) {
  // So are all wide-angle models: at 30 degrees the eye is 1 to 4 D stronger along the meridian.
  for (int turn = 0; turn < 16; ++turn) {
    const double angle_rad = turn * std::acos(-1.0) / 8.0;
    const glm::dvec2 along(std::cos(angle_rad), std::sin(angle_rad));
    const glm::dvec3 power = typicalField().at(24.0 * along, false).power_D;
    const double astigmatism_D =
        2.0 * (power.y * std::cos(2.0 * angle_rad) + power.z * std::sin(2.0 * angle_rad));
    EXPECT_GT(astigmatism_D, 0.4) << turn;
    EXPECT_LT(astigmatism_D, 4.0) << turn;
  }
}

TEST(PupilShape, IsRoundAtTheGazeAndNarrowsAlongTheMeridian) {
  EXPECT_NEAR(pupilShape({0.0, 0.0}, false)[0][0], 1.0, 1e-12);
  const glm::dmat2 right = pupilShape({40.0, 0.0}, false), left = pupilShape({-40.0, 0.0}, false);
  EXPECT_NEAR(right[1][1], 1.0, 1e-12);
  // Mathur and others 2013: cos(34.7 / 1.121) and cos(45.3 / 1.121), over cos(5.3 / 1.121).
  EXPECT_NEAR(right[0][0], 0.8608, 1e-3);
  EXPECT_NEAR(left[0][0], 0.7641, 1e-3);
  EXPECT_EQ(pupilShape({-40.0, 7.0}, true)[0][0], pupilShape({40.0, 7.0}, false)[0][0]);
}

Defocus defocusOn(const View& view) {
  return defocusOfLens(4e-3, view.focal_px, 1.0, DistanceAlong::sight);
}
const View kView{.size_px = {800, 600}, .focal_px = {500.0f, 500.0f}, .principal_px = {400, 300}};

TEST(LensField, IsTheStudysLensAtTheGaze) {
  Defocus defocus = defocusOn(kView);
  const LensField field(typicalField(), false, kView, kView.principal_px, defocus);
  const glm::mat2 blur = field.at({0.0f, 0.0f}).blur_px(defocus, 2.0f);
  EXPECT_NEAR(blur[0][0], -1.0f, 0.01f);  // 2 mm, 1 D, 500 px
  EXPECT_NEAR(blur[1][1], -1.0f, 0.01f);
  EXPECT_NEAR(blur[0][1], 0.0f, 0.01f);
}

TEST(LensField, BoundsHoldAroundAPlace) {
  Defocus defocus = defocusOn(kView);
  const LensField field(typicalField(), true, kView, {250.0f, 300.0f}, defocus);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int i = 0; i < 500; ++i) {
    const glm::vec2 at(380.0f * unit(random), 280.0f * unit(random));
    const float point_D = 1.5f + unit(random), around_px = 20.0f;
    const auto [least, most] = field.blurBounds_px(at, around_px, defocus, point_D, 0.2f);
    const glm::vec2 near = at + around_px * 0.7f * glm::vec2(unit(random), unit(random));
    const glm::mat2 blur = field.at(near).blur_px(defocus, point_D + 0.2f * unit(random));
    const float angle_rad = 3.2f * unit(random);
    const float radius = glm::length(blur * glm::vec2(std::cos(angle_rad), std::sin(angle_rad)));
    EXPECT_LE(least, radius + 1e-3f);
    EXPECT_GE(most, radius - 1e-3f);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
