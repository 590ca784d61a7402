#include "render/kernel/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace foci {
namespace FOCI_FILE {

constexpr double kQuadrature = 1e-5;  // of 4000 midpoints, and the table's floats

/// Integral over the unit disc of q^power times the kernel, q = r^2.
double moment(const KernelShape& k, int power) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double q = (i + 0.5) / kSteps, t = 1.0 - q;
    sum += std::pow(q, power) * (k.k0 + k.k1 * t + k.k2 * t * t) / kSteps;
  }
  return std::numbers::pi * sum;  // area element of the disc: pi dq
}

TEST(KernelShape, HasUnitMassAndTheStatedVariance) {
  for (float n : {0.0f, 0.1f, 0.5f, 0.99f, 1.0f, 1.3f, 2.0f}) {
    const KernelShape& k = kernelShape(n);
    EXPECT_NEAR(moment(k, 0), 1.0, kQuadrature) << "n " << n;
    // E[r^2] = 2 variances; with support^2 = support2 variances it is 2 / support2.
    EXPECT_NEAR(moment(k, 1) * k.support2 / 2.0, 1.0, kQuadrature) << "n " << n;
  }
}

TEST(KernelShape, HasTheKurtosisOfThePower) {
  for (float n : {0.0f, 0.25f, 0.5f, 1.0f, 1.5f, 2.0f}) {
    const KernelShape& k = kernelShape(n);
    const double mean = moment(k, 1);
    EXPECT_NEAR(moment(k, 2) / (mean * mean), 2.0 * (n + 2.0) / (n + 3.0), kQuadrature)
        << "n " << n;
  }
}

TEST(KernelShape, IsTheDiscAtZero) {
  const KernelShape& k = kernelShape(0.0f);
  EXPECT_FLOAT_EQ(k.k0, 1.0f / std::numbers::pi_v<float>);
  EXPECT_FLOAT_EQ(k.k1, 0.0f);
  EXPECT_FLOAT_EQ(k.k2, 0.0f);
  EXPECT_FLOAT_EQ(k.support2, 4.0f);
}

TEST(KernelShape, IsNowhereNegative) {
  for (float n = 0.0f; n <= 2.0f; n += 0.01f) {
    const KernelShape& k = kernelShape(n);
    for (float t = 0.0f; t <= 1.0f; t += 0.05f) {
      EXPECT_GE(k.k0 + k.k1 * t + k.k2 * t * t, 0.0f) << "n " << n << " t " << t;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
