#include "render/kernel/kernel.h"

#include <numbers>

namespace foci {
namespace {

constexpr int kTableSteps = kKernelShapes - 1;

/// The mixture (1 - alpha) t^i + alpha t^(i+1), each power of unit mass on one support, with
/// E[r^4] / E[r^2]^2 = 2 (n + 2) / (n + 3), the kurtosis of (1 - q)^n.
KernelShape solveShape(double n) {
  const int i = std::min(static_cast<int>(n), 1);
  const double a = 1.0 / (i + 2), b = 1.0 / (i + 3);  // E[r^2] / R^2 of the two powers
  const double e = 2.0 * a * b, f = 2.0 / ((i + 3.0) * (i + 4.0));  // E[r^4] / R^4
  const double kurtosis = 2.0 * (n + 2.0) / (n + 3.0);

  // kurtosis (a + alpha (b - a))^2 = e + alpha (f - e)
  const double p = kurtosis * (b - a) * (b - a);
  const double h = kurtosis * a * (b - a) - 0.5 * (f - e);
  const double c = kurtosis * a * a - e;
  // The root in [0, 1]; c = 0 at integer n.
  const double root = std::sqrt(std::max(0.0, h * h - p * c));
  const double alpha = std::clamp(c / (-h + root), 0.0, 1.0);

  // A unit mass of t^m over the unit disc is (m + 1) / pi t^m.
  std::array<double, 3> k{};
  k[i] = (1.0 - alpha) * (i + 1) / std::numbers::pi;
  k[i + 1] = alpha * (i + 2) / std::numbers::pi;
  const double mean_r2 = a + alpha * (b - a);  // both axes together
  return {static_cast<float>(k[0]), static_cast<float>(k[1]), static_cast<float>(k[2]),
          static_cast<float>(2.0 / mean_r2)};
}

std::array<KernelShape, kKernelShapes> tabulateShapes() {
  std::array<KernelShape, kKernelShapes> table{};
  for (int s = 0; s <= kTableSteps; ++s)
    table[s] = solveShape(double{kMaxExponent} * s / kTableSteps);
  return table;
}

}  // namespace

const std::array<KernelShape, kKernelShapes>& kernelShapes() {
  static const auto table = tabulateShapes();
  return table;
}

}  // namespace foci
