#include "render/optics/defocus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace foci {
namespace FOCI_FILE {

constexpr double kPrinted = 5e-5;   // digits of the test vectors in docs/formulas.md, section 1
constexpr double kRounding = 1e-9;  // a handful of double operations

/// Distance behind a thin lens at which a point `object_m` away is sharp: V = F U / (U - F), Eq. 1.
/// Singular at U = F (returns infinity).
double imageDistance_m(double focal_length_m, double object_m) {
  const double vergence_D = 1.0 / focal_length_m - 1.0 / object_m;
  return vergence_D == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / vergence_D;
}

/// Radius on the image plane, C = (A/2) |V_U - V_P| / V_U (Eq. 2). Singular like Eq. 1.
double circleOfConfusion_m(double aperture_m, double focal_length_m, double point_m,
                           double focus_m) {
  const double v_point_m = imageDistance_m(focal_length_m, point_m);
  const double v_focus_m = imageDistance_m(focal_length_m, focus_m);
  return aperture_m / 2.0 * std::abs(v_point_m - v_focus_m) / v_point_m;
}

double eyeRadius_px(double pupil_m, double point_m, double focus_m, double px_per_m,
                    double screen_m) {
  const auto focal_px = glm::vec2(static_cast<float>(px_per_m * screen_m));
  const Defocus eye = defocusOfLens(pupil_m, focal_px, 1.0 / focus_m, DistanceAlong::sight);
  return blurRadius_px(eye, static_cast<float>(1.0 / point_m)).x;
}

TEST(BlurRadius, MatchesTheTestVectors) {
  const double px_per_m_96dpi = 96.0 / 0.0254;
  EXPECT_NEAR(retinalRadius_m(0.004, 0.024, 1.0, 2.0), 48e-6, kRounding);
  EXPECT_NEAR(glm::degrees(blurAngle_rad(0.004, 1.0, 2.0)) * 60.0, 13.751, 5e-4);
  EXPECT_NEAR(eyeRadius_px(0.004, 1.0, 0.5, px_per_m_96dpi, 0.6), 4.5354, kPrinted);
  EXPECT_NEAR(eyeRadius_px(0.004, 0.25, 1.0, px_per_m_96dpi, 0.6), 13.6063, kPrinted);
  EXPECT_NEAR(eyeRadius_px(0.004, 0.5, 1.0, 4000.0, 0.6), 4.8, kPrinted);
  EXPECT_NEAR(eyeRadius_px(0.004, 0.25, 1.0, 4000.0, 0.6), 14.4, kPrinted);
  EXPECT_NEAR(eyeRadius_px(0.008, 0.25, 1.0, 4000.0, 0.6), 28.8, kPrinted);
  EXPECT_NEAR(glm::degrees(blurAngle_rad(0.001, 0.0, 1.0)) * 60.0, 3.4377, kPrinted);
}

TEST(BlurRadius, IsZeroInFocus) {
  for (float focus_D : {0.0f, 0.1f, 1.0f, 3.3f, 10.0f}) {
    const Defocus eye = defocusOfLens(0.004, glm::vec2(2000.0f), focus_D, DistanceAlong::sight);
    EXPECT_EQ(blurRadius_px(eye, focus_D).x, 0.0f);
  }
}

TEST(BlurRadius, DioptricFormAgreesWithThinLensWhereThatIsDefined) {
  // Focal length of the eye focused at P: 1/F = 1/P + 1/V_P.
  const double retina_m = 0.024;
  for (double focus_m : {0.25, 0.5, 1.0, 7.0}) {
    const double focal_m = 1.0 / (1.0 / focus_m + 1.0 / retina_m);
    for (double point_m : {0.1, 0.3, 1.0, 2.0, 100.0}) {
      EXPECT_NEAR(circleOfConfusion_m(0.004, focal_m, point_m, focus_m),
                  retinalRadius_m(0.004, retina_m, 1.0 / point_m, 1.0 / focus_m), 1e-12)
          << "U " << point_m << " m, P " << focus_m << " m";
    }
  }
}

TEST(BlurRadius, IsFiniteWhereThinLensIsSingular) {
  const Defocus eye = defocusOfLens(0.004, glm::vec2(2000.0f), 0.0, DistanceAlong::sight);
  EXPECT_EQ(blurRadius_px(eye, 0.0f).x, 0.0f);                          // both at infinity
  EXPECT_FLOAT_EQ(blurRadius_px(eye, 1.0f / 0.024f).x, 4.0f / 0.024f);  // U = F
  EXPECT_TRUE(std::isinf(imageDistance_m(0.024, 0.024)));
  EXPECT_DOUBLE_EQ(imageDistance_m(0.024, std::numeric_limits<double>::infinity()), 0.024);
}

TEST(BlurRadius, OnScreenIgnoresTheRetinaButOnTheRetinaGrowsWithIt) {
  EXPECT_DOUBLE_EQ(retinalRadius_m(0.004, 0.048, 1.0, 2.0),
                   2.0 * retinalRadius_m(0.004, 0.024, 1.0, 2.0));
  // On screen: C d_s / V_P R for any V_P (Eq. 4).
  for (double retina_m : {0.017, 0.024, 0.03}) {
    const double screen_px = retinalRadius_m(0.004, retina_m, 1.0, 2.0) * 0.6 / retina_m * 4000.0;
    EXPECT_NEAR(screen_px, eyeRadius_px(0.004, 1.0, 0.5, 4000.0, 0.6), 1e-5);
  }
}

TEST(BlurRadius, OfCameraMatchesEquation3) {
  // glFrustum(-0.1, 0.1, -0.1, 0.1, 0.2, ...), 512 x 512: C N / V_P H / (T - B).
  const double aperture_m = 0.05, focal_m = 0.1, focus_m = 2.0, point_m = 3.0;
  const double v_focus_m = imageDistance_m(focal_m, focus_m);
  const double expected_px =
      circleOfConfusion_m(aperture_m, focal_m, point_m, focus_m) * 0.2 / v_focus_m * 512.0 / 0.2;
  const Defocus camera = defocusOfLens(aperture_m, glm::vec2(512.0f * 0.2f / 0.2f), 1.0 / focus_m,
                                       DistanceAlong::axis);
  EXPECT_NEAR(blurRadius_px(camera, static_cast<float>(1.0 / point_m)).x, expected_px, 1e-5);
}

}  // namespace FOCI_FILE
}  // namespace foci
