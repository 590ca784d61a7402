#include "render/kernel/kernel.h"

#include <numbers>

namespace foci {
namespace {

constexpr int kTableSteps = kKernelShapes - 1;

/// @param n  in [0, 2]; the kurtosis E[r^4] / E[r^2]^2 of (1 - q)^n is 2 (n + 2) / (n + 3)
KernelShape solveShape(double n) {
  const double kurtosis = 2.0 * (n + 2.0) / (n + 3.0);
  if (n < 1.0) {
    // A plateau up to q = a has E[q] = (1 + a + a^2) / (3 + 3 a) and E[q^2] = (1 + a^2) / 6.
    const auto meanOf = [](double a) { return (1.0 + a + a * a) / (3.0 + 3.0 * a); };
    double a = 0.0, too_wide = 0.999;  // 1: the disc
    while (too_wide - a > 1e-9) {
      const double middle = 0.5 * (a + too_wide), mean = meanOf(middle);
      ((1.0 + middle * middle) / (6.0 * mean * mean) > kurtosis ? a : too_wide) = middle;
    }
    const double peak = 2.0 / (std::numbers::pi * (1.0 + a));
    return {static_cast<float>(peak), static_cast<float>(peak / (1.0 - a)), 0.0f,
            static_cast<float>(2.0 / meanOf(a))};
  }

  // The mixture (1 - alpha) t + alpha t^2, each power of unit mass on one support.
  constexpr double a = 1.0 / 3.0, b = 1.0 / 4.0;   // E[r^2] / R^2 of the two powers
  constexpr double e = 1.0 / 6.0, f = 1.0 / 10.0;  // E[r^4] / R^4

  // kurtosis (a + alpha (b - a))^2 = e + alpha (f - e)
  const double p = kurtosis * (b - a) * (b - a);
  const double h = kurtosis * a * (b - a) - 0.5 * (f - e);
  const double c = kurtosis * a * a - e;
  // The root in [0, 1]; c = 0 at n = 1.
  const double root = std::sqrt(std::max(0.0, h * h - p * c));
  const double alpha = std::clamp(c / (-h + root), 0.0, 1.0);

  // A unit mass of t^m over the unit disc is (m + 1) / pi t^m.
  const auto k1 = static_cast<float>((1.0 - alpha) * 2.0 / std::numbers::pi);
  const auto k2 = static_cast<float>(alpha * 3.0 / std::numbers::pi);
  return {k1 + k2, k1, k2, static_cast<float>(2.0 / (a + alpha * (b - a)))};
}

std::array<KernelShape, kKernelShapes> tabulateShapes() {
  std::array<KernelShape, kKernelShapes> table{};
  for (int s = 0; s <= kTableSteps; ++s) {
    const double root = static_cast<double>(s) / kTableSteps;
    table[s] = solveShape(kMaxExponent * root * root);
  }
  return table;
}

}  // namespace

const std::array<KernelShape, kKernelShapes>& kernelShapes() {
  static const auto table = tabulateShapes();
  return table;
}

}  // namespace foci
