#include "render/literature/paper/circumellipse.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr float kTolerance = 4e-6f;  // a dozen float roundings, of values up to some units

Variance rotated(double major, double minor, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {static_cast<float>(c * c * major + s * s * minor),
          static_cast<float>(c * s * (major - minor)),
          static_cast<float>(s * s * major + c * c * minor)};
}

void expectNear(const Variance& a, const Variance& b, float scale) {
  EXPECT_NEAR(a.xx, b.xx, kTolerance * scale);
  EXPECT_NEAR(a.xy, b.xy, kTolerance * scale);
  EXPECT_NEAR(a.yy, b.yy, kTolerance * scale);
}

TEST(Circumellipse, RaisesEachEigenvalueToTheCircleAndKeepsTheEigenvectors) {
  for (double angle_rad = 0.0; angle_rad < 3.2; angle_rad += 0.1) {
    for (float circle : {0.0f, 0.5f, 1.0f, 2.0f, 3.0f, 5.0f}) {
      const Variance w = circumellipse(rotated(3.0, 1.0, angle_rad), circle);
      expectNear(w, rotated(std::fmax(3.0, circle), std::fmax(1.0, circle), angle_rad), 3.0f);
    }
  }
}

TEST(Circumellipse, IsTheCircleForASmallerEllipse) {
  expectNear(circumellipse({0.0f, 0.0f, 0.0f}, 2.0f), {2.0f, 0.0f, 2.0f}, 2.0f);
  expectNear(circumellipse({1.0f, 0.0f, 1.0f}, 2.0f), {2.0f, 0.0f, 2.0f}, 2.0f);
  expectNear(circumellipse(rotated(1.9, 0.0, 0.7), 2.0f), {2.0f, 0.0f, 2.0f}, 2.0f);
}

TEST(Circumellipse, OfNothingIsNothing) {
  expectNear(circumellipse({0.0f, 0.0f, 0.0f}, 0.0f), {0.0f, 0.0f, 0.0f}, 1.0f);
}

TEST(Circumellipse, IsAccurateForEllipsesABillionTimesLongerThanWide) {
  const Variance w = circumellipse(rotated(1e9, 1e-9, 0.4), 1.0f);
  expectNear(w, rotated(1e9, 1.0, 0.4), 1e9f);
  EXPECT_GE(w.xx, 0.0f);
  EXPECT_GE(w.yy, 0.0f);
}

TEST(Circumellipse, OfTwoEllipsesContainsBothTightly) {
  for (double angle_rad = 0.0; angle_rad < 3.2; angle_rad += 0.3) {
    const Variance b = rotated(4.0, 0.5, angle_rad), c = rotated(3.0, 1.0, 0.7);
    const Variance w = circumellipse(b, c);
    for (double along_rad = 0.0; along_rad < 3.2; along_rad += 0.1) {
      const auto variance = [&](const Variance& v) {
        const double x = std::cos(along_rad), y = std::sin(along_rad);
        return v.xx * x * x + 2.0 * v.xy * x * y + v.yy * y * y;
      };
      EXPECT_GE(variance(w), std::fmax(variance(b), variance(c)) - 1e-4);
      EXPECT_LE(variance(w), variance(b) + variance(c) + 1e-4);
    }
  }
  // If one of them is a circle, both functions agree.
  expectNear(circumellipse(rotated(3.0, 1.0, 0.4), Variance{2.0f, 0.0f, 2.0f}),
             circumellipse(rotated(3.0, 1.0, 0.4), 2.0f), 3.0f);
}

TEST(Circumellipse, OfNothingAndALineIsTheLine) {
  expectNear(circumellipse({0.0f, 0.0f, 0.0f}, rotated(9.0, 0.0, 0.5)), rotated(9.0, 0.0, 0.5),
             9.0f);
}

}  // namespace FOCI_FILE
}  // namespace foci
