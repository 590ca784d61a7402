#include "app/evaluation/stability/closed_forms.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace foci::stability {

double edgeShare(double distance_px, double radius_px, double sigma_px) {
  const auto disc = [&](double x) {
    if (radius_px <= 0.0) return x > 0.0 ? 1.0 : x < 0.0 ? 0.0 : 0.5;
    const double t = std::clamp(x / radius_px, -1.0, 1.0);
    return (std::acos(-t) + t * std::sqrt(1.0 - t * t)) / glm::pi<double>();
  };
  if (radius_px <= 0.0) return 0.5 * std::erfc(-distance_px / (sigma_px * std::sqrt(2.0)));
  constexpr int kSteps = 48;
  double sum = 0.0, total = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double z = 4.0 * i / kSteps;
    const double w = std::exp(-0.5 * z * z);
    sum += w * disc(distance_px - z * sigma_px);
    total += w;
  }
  return sum / total;
}

double discThroughGaussian(double distance_px, double radius_px, double sigma_px) {
  constexpr int kSteps = 200;
  const double s2 = sigma_px * sigma_px, step_px = radius_px / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = (i + 0.5) * step_px, x = r * distance_px / s2;
    // exp(-x) I0(x), which does not overflow; for large x its asymptotic series (DLMF 10.40.1).
    const double bessel = x < 50.0 ? std::exp(-x) * std::cyl_bessel_i(0.0, x)
                                   : (1.0 + 0.125 / x) / std::sqrt(glm::two_pi<double>() * x);
    const double off = r - distance_px;
    sum += r * std::exp(-0.5 * off * off / s2) * bessel * step_px;
  }
  return sum / (glm::pi<double>() * radius_px * radius_px * s2);
}

}  // namespace foci::stability
