#include "render/normalisation/kernel_overlap.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "render/normalisation/pair_sums.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kQuadrature = 1e-4f;  // of the table

/// F of kernel_overlap.h, from two surfels of which the first has no weight.
float overlap(float q, float ratio) {
  const float variances = 1.0f + ratio * ratio;
  const glm::vec3 up(0.0f, 0.0f, 1.0f);
  const std::array<PairSurfel, 2> surfels{
      {{glm::vec3(0.0f), 1.0f, up, 0.0f},
       {{4.0f * std::sqrt(q * variances), 0.0f, 0.0f}, ratio * ratio, up, 1.0f}}};
  const std::array<std::uint32_t, 1> near{1};
  return variances * renderedPairs({surfels, 0, up, near, 1}, 0.0f).covered;
}

TEST(KernelOverlap, OfAKernelWithItselfIsTheIntegralOfItsSquare) {
  // 9 / (5 pi R^2) with R^2 = 8 v, times 2 v.
  EXPECT_NEAR(overlap(0.0f, 1.0f), 9.0f / (20.0f * std::numbers::pi_v<float>), kQuadrature);
}

TEST(KernelOverlap, IntegratesToOneForAllSizes) {
  for (const float ratio : {0.4f, 0.55f, 0.8f, 1.0f}) {
    double sum = 0.0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
      sum += overlap((static_cast<float>(i) + 0.5f) / kSteps, ratio) / kSteps;
    }
    EXPECT_NEAR(16.0 * std::numbers::pi * sum, 1.0, 2e-3) << ratio;
  }
}

TEST(KernelOverlap, EndsWhereKernelsTouch) {
  const KernelOverlap& table = KernelOverlap::table();
  EXPECT_NEAR(table.beyond(0.0f), 1.0f, 2e-3f);
  EXPECT_EQ(overlap(1.001f, 1.0f), 0.0f);
  EXPECT_EQ(table.beyond(1.0f), 0.0f);
  // Kernels of radii 0.4 and 1 touch at (R1 + R2)^2 / 2 (R1^2 + R2^2).
  const float touch = 1.4f * 1.4f / (2.0f * 1.16f);
  EXPECT_NEAR(overlap(touch + 0.01f, 0.4f), 0.0f, kQuadrature);
  EXPECT_GT(overlap(0.5f * touch, 0.4f), kQuadrature);
  float before = 1.0f;
  for (float q = 0.0f; q < 1.0f; q += 0.05f) {
    EXPECT_LT(overlap(q, 1.0f), before);
    before = overlap(q, 1.0f);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
