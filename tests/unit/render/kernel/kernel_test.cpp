#include "render/kernel/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace foci {
namespace FOCI_FILE {

constexpr double kQuadrature = 2e-5;  // of 4000 midpoints, and the table's floats

/// Integral over the unit disc of q^power times the kernel, q = r^2.
double moment(const KernelShape& k, int power) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double q = (i + 0.5) / kSteps, t = 1.0 - q;
    sum += std::pow(q, power) * k.at(static_cast<float>(t)) / kSteps;
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
  for (const int entry : {0, 8, 64, 128, 181, 182, 192, 256}) {  // of the table
    const float root = static_cast<float>(entry) / 256.0f, n = kMaxExponent * root * root;
    const KernelShape& k = kernelShape(n);
    const double mean = moment(k, 1);
    EXPECT_NEAR(moment(k, 2) / (mean * mean), 2.0 * (n + 2.0) / (n + 3.0), kQuadrature)
        << "n " << n;
  }
}

TEST(KernelShape, IsTheDiscAtZero) {
  const KernelShape& k = kernelShape(0.0f);
  EXPECT_NEAR(k.at(1.0f), 1.0f / std::numbers::pi_v<float>, 2e-4f);
  EXPECT_NEAR(k.at(0.002f), k.at(1.0f), 1e-6f);
  EXPECT_NEAR(k.support2, 4.0f, 0.01f);
}

/// A disc of radius 1 through a Gaussian of standard deviation `sigma`, `off` from its middle:
/// Simpson's rule over chords.
double discThroughBell(double off, double sigma) {
  constexpr int kSteps = 400;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = 2.0 * i / kSteps - 1.0, half = std::sqrt(1.0 - x * x);
    const double bell = std::exp(-0.5 * (x - off) * (x - off) / (sigma * sigma));
    const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight * bell * std::erf(half / (sigma * std::sqrt(2.0)));
  }
  return sum * (2.0 / kSteps / 3.0) / (sigma * std::sqrt(2.0 * std::numbers::pi)) /
         std::numbers::pi;
}

// The rim of a far blurred point is as soft as its unblurred splat.
TEST(KernelShape, IsNearlyTheDiscThroughAGaussian) {
  for (const double sigma : {0.05, 0.1, 0.15}) {
    const auto s = static_cast<float>(sigma * sigma), variance = s + 0.25f;
    const KernelShape& k = kernelShape(kernelExponent(s));
    for (double r = 0.0; r < 1.6; r += 0.02) {
      const auto t = static_cast<float>(1.0 - r * r / (double{k.support2} * variance));
      const double own = t > 0.0f ? k.at(t) / (k.support2 * variance) : 0.0;
      EXPECT_NEAR(own, discThroughBell(r, sigma), 0.08 / std::numbers::pi) << sigma << " " << r;
    }
  }
}

TEST(KernelShape, IsContinuousAndNowhereNegative) {
  for (float n = 0.0f; n <= 2.0f; n += 0.01f) {
    const KernelShape& k = kernelShape(n);
    EXPECT_LE(k.at(1e-6f), 1e-3f) << "n " << n;
    for (float t = 0.05f; t <= 1.0f; t += 0.05f) {
      EXPECT_GE(k.at(t), k.at(t - 0.049f)) << "n " << n << " t " << t;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
