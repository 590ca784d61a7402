// Edges in a pixel against closed forms: half-planes seen through a Gaussian footprint.
#include "render/kernel/pixel_edge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "render/kernel/kernel.h"

namespace foci {
namespace FOCI_FILE {

double coveredBy(double t) { return 0.5 * std::erfc(-t / std::sqrt(2.0)); }
double density(double t) { return std::exp(-0.5 * t * t) / std::sqrt(glm::two_pi<double>()); }

/// The edge of the half-plane n d > -t, in standard deviations of the footprint.
PixelEdge halfPlane(double t, float angle) {
  const double area = coveredBy(t), mean = density(t) / area / std::sqrt(kWidestSupport2);
  const glm::vec2 n(std::cos(angle), std::sin(angle));
  return pixelEdgeOf(static_cast<float>(area), static_cast<float>(mean) * n,
                     static_cast<float>(area));
}

/// Share of the footprint that both half-planes cover, by integration: along the first normal, the
/// second half-plane covers Phi((t2 + r s) / sqrt(1 - r^2)).
double sharedExactly(double t1, double t2, double angle) {
  const double r = std::cos(angle), rest = std::sqrt(std::max(1.0 - r * r, 1e-12));
  double sum = 0.0;
  constexpr double kStep = 0.002;
  for (double s = -t1 + 0.5 * kStep; s < 6.0; s += kStep) {
    sum += kStep * density(s) * coveredBy((t2 + r * s) / rest);
  }
  return sum;
}

TEST(PixelEdge, KnowsAHalfPlaneFromAnEvenCover) {
  for (const double t : {-1.5, -0.7, 0.0, 0.7, 1.5}) {
    EXPECT_NEAR(glm::length(halfPlane(t, 0.4f).direction), 1.0f, 0.06f) << t;
  }
  EXPECT_EQ(pixelEdgeOf(0.5f, glm::vec2(0.0f), 0.5f).direction, glm::vec2(0.0f));
}

TEST(PixelEdge, SharesWhatTwoHalfPlanesShare) {
  for (const double t1 : {-0.8, 0.0, 0.8}) {
    for (const double t2 : {-0.8, 0.0, 0.8}) {
      for (double angle = 0.5 * glm::pi<double>(); angle < 3.15; angle += glm::pi<double>() / 8) {
        const float shared =
            sharedBy(halfPlane(t1, 0.3f), halfPlane(t2, 0.3f + static_cast<float>(angle)));
        EXPECT_NEAR(shared, sharedExactly(t1, t2, angle), 0.04) << t1 << " " << t2 << " " << angle;
      }
    }
  }
}

TEST(PixelEdge, TakesEdgesOnOneSideAsIndependent) {
  for (const float angle : {0.0f, 0.7f, 1.5f}) {
    EXPECT_NEAR(sharedBy(halfPlane(0.0, 0.3f), halfPlane(0.0, 0.3f + angle)), 0.25f, 1e-3f);
  }
}

TEST(PixelEdge, HidesTheBackBehindTheFrontUnlessTheyLieApart) {
  const PixelEdge left = halfPlane(0.0, glm::pi<float>()), right = halfPlane(0.0, 0.0f);
  EXPECT_NEAR(besideFront(left, left), 0.0f, 1e-5f);
  EXPECT_NEAR(besideFront(left, halfPlane(0.7, glm::pi<float>())), 0.258f, 1e-3f);
  EXPECT_NEAR(besideFront(left, right), 0.5f, 0.01f);  // one sheet
}

TEST(PixelEdge, SeesAllOfALayerOnTheOtherSide) {
  const PixelEdge left = halfPlane(0.0, glm::pi<float>()), right = halfPlane(0.0, 0.0f);
  EXPECT_NEAR(seenOverIndependent(left, 1.0f, right), 2.0f, 0.01f);  // nothing is hidden
  EXPECT_NEAR(seenOverIndependent(left, 1.0f, left), 1.0f, 1e-5f);   // independent
  EXPECT_NEAR(seenOverIndependent(left, 0.0f, left), 1.0f, 1e-5f);   // behind clear glass
  EXPECT_NEAR(seenOverIndependent(left, 0.5f, right), 4.0f / 3, 0.01f);
}

}  // namespace FOCI_FILE
}  // namespace foci
