// What the schematic eye adds beside the line of sight, against Coddington's equations and
// symmetry.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "app/eye/visual_quality.h"

namespace foci {
namespace FOCI_FILE {

/// Vergence of light from a point of the retina at the entrance pupil, along the field's meridian
/// and across it, dioptres: Coddington's equations along the chief ray (Born and Wolf, Principles
/// of Optics, section 4.6).
struct Oblique {
  double field_deg, along_D, across_D;
};
/// @param stop_angle_rad  of the chief ray in front of the lens
Oblique coddington(double stop_angle_rad) {
  struct Surface {
    double vertex_mm, radius_mm, conic, outside, inside;
  };
  constexpr std::array<Surface, 4> kSurfaces = {{{0.0, 7.72, -0.26, 1.0, 1.3777},
                                                 {0.55, 6.5, 0.0, 1.3777, 1.3391},
                                                 {3.6, 10.2, -3.1316, 1.3391, 1.4222},
                                                 {7.6, -6.0, -1.0, 1.4222, 1.3377}}};
  // Where a ray crosses a surface, by bisection.
  const auto cross = [](glm::dvec2 at, glm::dvec2 to, double vertex, double radius, double conic,
                        double from_t, double end_t) {
    const auto side = [&](double t) {
      const glm::dvec2 p = at + t * to;  // (z, x)
      const double z = p.x - vertex;
      return p.y * p.y + (1.0 + conic) * z * z - 2.0 * radius * z;
    };
    const bool sign = side(from_t) > 0.0;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (from_t + end_t);
      ((side(middle) > 0.0) == sign ? from_t : end_t) = middle;
    }
    return at + from_t * to;
  };
  const auto normalAt = [](glm::dvec2 p, const Surface& s) {
    return glm::normalize(
        glm::dvec2((1.0 + s.conic) * (p.x - s.vertex_mm) - s.radius_mm, p.y));  // (z, x)
  };
  const auto bend = [&](glm::dvec2 to, glm::dvec2 normal, double from, double into) {
    if (glm::dot(to, normal) > 0.0) normal = -normal;
    return glm::refract(to, normal, from / into);
  };
  // Backwards through the lens.
  const glm::dvec2 stop(3.6, 0.0);
  glm::dvec2 to(std::cos(stop_angle_rad), -std::sin(stop_angle_rad));
  const glm::dvec2 in_lens = bend(to, {-1.0, 0.0}, 1.3391, 1.4222);
  const glm::dvec2 back = cross(stop, in_lens, 7.6, -6.0, -1.0, 0.0, 6.0);
  const glm::dvec2 in_vitreous = bend(in_lens, normalAt(back, kSurfaces[3]), 1.4222, 1.3377);
  const glm::dvec2 retina = cross(back, in_vitreous, 23.9203, -12.0, 0.0, 1.0, 23.0);
  // Outwards: vergences n / distance, below 0 where light diverges.
  to = -in_vitreous;
  glm::dvec2 at = back;
  double along = -1.3377 / glm::distance(retina, back), across = along;
  for (int i = 3; i >= 0; --i) {
    const Surface& s = kSurfaces[static_cast<std::size_t>(i)];
    const glm::dvec2 normal = normalAt(at, s);
    const glm::dvec2 out = bend(to, normal, s.inside, s.outside);
    const double cos_in = std::abs(glm::dot(to, normal));
    const double cos_out = std::abs(glm::dot(out, normal));
    // Radii of the conic at height x: R_s = sqrt(R^2 - Q x^2), R_t = R_s^3 / R^2.
    const double sagittal =
        std::copysign(std::sqrt(s.radius_mm * s.radius_mm - s.conic * at.y * at.y), s.radius_mm);
    const double tangential = std::pow(sagittal, 3) / (s.radius_mm * s.radius_mm);
    const double oblique = s.inside * cos_in - s.outside * cos_out;
    across += oblique / sagittal;
    along = (along * cos_in * cos_in + oblique / tangential) / (cos_out * cos_out);
    to = out;
    if (i == 0) break;
    const Surface& next = kSurfaces[static_cast<std::size_t>(i - 1)];
    const glm::dvec2 met = i == 3 ? stop
                                  : cross(at, to, next.vertex_mm, next.radius_mm, next.conic,
                                          i == 2 ? 0.5 : 0.05, 5.0);
    const double way = glm::distance(met, at);
    along /= 1.0 - way * along / s.outside;
    across /= 1.0 - way * across / s.outside;
    at = met;
  }
  // The entrance pupil lies where the ray meets the axis.
  const double way = -at.y / to.y;
  along /= 1.0 - way * along;
  across /= 1.0 - way * across;
  return {std::atan2(to.y, -to.x) * 180.0 / std::numbers::pi, 1e3 * along, 1e3 * across};
}

TEST(FieldWavefront, OfASmallPupilIsThatOfCoddington) {
  const Oblique axis = coddington(1e-4);
  EXPECT_NEAR(axis.along_D, axis.across_D, 1e-4);
  for (const double inside_rad : {0.15, 0.3, 0.5}) {
    const Oblique expected = coddington(inside_rad);
    const glm::dvec3 power = power_D(fieldOfEye(expected.field_deg, 0.5e-3).added);
    EXPECT_NEAR(power.x, 0.5 * (expected.along_D + expected.across_D) - axis.along_D, 0.02)
        << expected.field_deg;
    EXPECT_NEAR(power.y, 0.5 * (expected.along_D - expected.across_D), 0.02) << expected.field_deg;
    EXPECT_NEAR(power.z, 0.0, 1e-6);
    EXPECT_GT(power.y, 0.05);
  }
}

TEST(FieldWavefront, IsMirroredOnTheOtherSide) {
  const Wavefront right = fieldOfEye(25.0, 4e-3).added, left = fieldOfEye(-25.0, 4e-3).added;
  ASSERT_EQ(right.zernike_um.size(), left.zernike_um.size());
  for (int j = 3; j < static_cast<int>(right.zernike_um.size()); ++j) {
    const auto [n, m] = zernikeOrder(j);
    // x to -x: cosines of odd m and sines of even m change their sign.
    const double sign = (m >= 0) == (m % 2 == 0) ? 1.0 : -1.0;
    const auto at = static_cast<std::size_t>(j);
    EXPECT_NEAR(right.zernike_um[at], sign * left.zernike_um[at], 1e-6) << j;
  }
  EXPECT_GT(std::abs(right.zernike_um[8]), 0.1);
}

TEST(FieldWavefront, IsNothingOnTheAxis) {
  for (const double um : fieldOfEye(0.0, 4e-3).added.zernike_um) EXPECT_NEAR(um, 0.0, 1e-9);
  EXPECT_NEAR(fieldOfEye(0.0, 4e-3).pupil_aspect, 1.0, 1e-3);
}

// A pupil seen from the side is wider than its foreshortened disc: the cornea turns it (Mathur,
// Gehrmann and Atchison 2013).
TEST(PupilAspect, LiesBetweenTheCosineAndOne) {
  for (const double field_deg : {20.0, 40.0, 60.0}) {
    const double aspect = fieldOfEye(field_deg, 4e-3).pupil_aspect;
    EXPECT_GT(aspect, std::cos(field_deg * std::numbers::pi / 180.0));
    EXPECT_LT(aspect, 1.0);
    EXPECT_NEAR(aspect, fieldOfEye(-field_deg, 4e-3).pupil_aspect, 1e-6);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
