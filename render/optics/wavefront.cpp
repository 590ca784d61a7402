#include "render/optics/wavefront.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace foci {
namespace {

double factorial(int n) { return std::tgamma(n + 1.0); }

double binomial(int n, int k) {
  return std::round(factorial(n) / (factorial(k) * factorial(n - k)));
}

double normOf(const ZernikeOrder& order) {
  return std::sqrt((order.m == 0 ? 1.0 : 2.0) * (order.n + 1));
}

/// Coefficient of r^(n - 2s) in the radial polynomial.
double radialCoefficient(const ZernikeOrder& order, int s) {
  const int m = std::abs(order.m);
  return (s % 2 == 0 ? 1.0 : -1.0) * factorial(order.n - s) /
         (factorial(s) * factorial((order.n + m) / 2 - s) * factorial((order.n - m) / 2 - s));
}

std::size_t monomial(int a, int b) {
  const int at = b + (a + b) * (a + b + 1) / 2;
  return static_cast<std::size_t>(at);
}

/// Adds `scale` times the polynomial to the coefficients of x^a y^b. The radial power r^(|m| + 2k)
/// with the angle is (x^2 + y^2)^k Re or Im (x + i y)^|m|.
void addZernike(const ZernikeOrder& order, double scale, std::vector<double>& coefficients) {
  const int m = std::abs(order.m);
  for (int s = 0; s <= (order.n - m) / 2; ++s) {
    const int k = (order.n - m) / 2 - s;
    const double radial = scale * normOf(order) * radialCoefficient(order, s);
    for (int i = 0; i <= k; ++i) {
      for (int t = order.m < 0 ? 1 : 0; t <= m; t += 2) {
        const double sign = (t / 2) % 2 == 0 ? 1.0 : -1.0;
        coefficients[monomial(m - t + 2 * (k - i), t + 2 * i)] +=
            radial * binomial(k, i) * binomial(m, t) * sign;
      }
    }
  }
}

}  // namespace

int zernikeIndex(const ZernikeOrder& order) { return (order.n * (order.n + 2) + order.m) / 2; }

ZernikeOrder zernikeOrder(int index) {
  const int n = static_cast<int>(std::ceil((-3.0 + std::sqrt(9.0 + 8.0 * index)) / 2.0));
  return {.n = n, .m = 2 * index - n * (n + 2)};
}

double zernike(const ZernikeOrder& order, const glm::dvec2& at) {
  const double r = glm::length(at), angle_rad = std::atan2(at.y, at.x);
  const int m = std::abs(order.m);
  double radial = 0.0;
  for (int s = 0; s <= (order.n - m) / 2; ++s) {
    radial += radialCoefficient(order, s) * std::pow(r, order.n - 2 * s);
  }
  return normOf(order) * radial * (order.m < 0 ? std::sin(m * angle_rad) : std::cos(m * angle_rad));
}

Wavefront::operator bool() const {
  for (std::size_t j = 3; j < zernike_um.size(); ++j) {
    if (zernike_um[j] != 0.0) return true;
  }
  return false;
}

Wavefront rescaled(const Wavefront& w, double pupil_m) {
  assert(pupil_m > 0.0 && (w.pupil_m > 0.0 || !w));
  Wavefront result{.zernike_um = std::vector<double>(w.zernike_um.size()), .pupil_m = pupil_m};
  const double k = w.pupil_m > 0.0 ? pupil_m / w.pupil_m : 1.0;
  for (int index = 0; index < static_cast<int>(w.zernike_um.size()); ++index) {
    const auto [n, m] = zernikeOrder(index);
    double sum = 0.0;
    for (int i = 0;; ++i) {
      const auto from = static_cast<std::size_t>(zernikeIndex({.n = n + 2 * i, .m = m}));
      if (from >= w.zernike_um.size()) break;
      double inner = 0.0;
      for (int j = 0; j <= i; ++j) {
        inner += ((i + j) % 2 == 0 ? 1.0 : -1.0) * factorial(n + i + j) /
                 (factorial(n + j + 1) * factorial(i - j) * factorial(j)) * std::pow(k, 2 * j);
      }
      sum += w.zernike_um[from] * std::sqrt((n + 2.0 * i + 1.0) * (n + 1.0)) * inner;
    }
    result.zernike_um[static_cast<std::size_t>(index)] = std::pow(k, n) * sum;
  }
  return result;
}

glm::dvec3 power_D(const Wavefront& w) {
  const auto um = [&](std::size_t j) { return j < w.zernike_um.size() ? w.zernike_um[j] : 0.0; };
  if (w.pupil_m <= 0.0) return glm::dvec3(0.0);
  const double per_um = 1e-6 / (0.25 * w.pupil_m * w.pupil_m);
  return per_um * glm::dvec3(4.0 * std::sqrt(3.0) * um(4), 2.0 * std::sqrt(6.0) * um(5),
                             2.0 * std::sqrt(6.0) * um(3));
}

Wavefront withPower(Wavefront w, const glm::dvec3& power_D) {
  const double per_D = 0.25 * w.pupil_m * w.pupil_m * 1e6;
  w.zernike_um.resize(std::max<std::size_t>(w.zernike_um.size(), 6));
  w.zernike_um[4] = per_D * power_D.x / (4.0 * std::sqrt(3.0));
  w.zernike_um[5] = per_D * power_D.y / (2.0 * std::sqrt(6.0));
  w.zernike_um[3] = per_D * power_D.z / (2.0 * std::sqrt(6.0));
  return w;
}

Wavefront withoutRefraction(Wavefront w) {
  std::fill_n(w.zernike_um.begin(), std::min<std::size_t>(6, w.zernike_um.size()), 0.0);
  return w;
}

double rms_um(const Wavefront& w, int lowest) {
  double squares = 0.0;
  for (auto j = static_cast<std::size_t>(zernikeCount(lowest - 1)); j < w.zernike_um.size(); ++j) {
    squares += w.zernike_um[j] * w.zernike_um[j];
  }
  return std::sqrt(squares);
}

PupilWavefront::PupilWavefront(const Wavefront& w) : radius_m_(0.5 * w.pupil_m) {
  assert(w.pupil_m > 0.0);
  const int count = static_cast<int>(w.zernike_um.size());
  order_ = count == 0 ? 0 : zernikeOrder(count - 1).n;
  assert(order_ <= kMaxZernikeOrder);
  coefficient_m_.assign(static_cast<std::size_t>(zernikeCount(order_)), 0.0);
  for (int j = 3; j < count; ++j) {
    const ZernikeOrder order = zernikeOrder(j);
    const double turned = order.n % 2 == 0 ? 1.0 : -1.0;  // by 180 degrees: W(-p)
    addZernike(order, 1e-6 * turned * w.zernike_um[static_cast<std::size_t>(j)], coefficient_m_);
  }
}

PupilWavefront::At PupilWavefront::at(const glm::dvec2& p) const {
  std::array<double, kMaxZernikeOrder + 1> x{1.0}, y{1.0};
  for (std::size_t i = 1; i < x.size(); ++i) {
    x[i] = x[i - 1] * p.x;
    y[i] = y[i - 1] * p.y;
  }
  At at;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (int n = 0; n <= order_; ++n) {
    for (int b = 0; b <= n; ++b) {
      const int a = n - b;
      const double c = coefficient_m_[monomial(a, b)];
      const auto power = [](const auto& powers, int exponent) {
        return exponent < 0 ? 0.0 : powers[static_cast<std::size_t>(exponent)];
      };
      at.error_m += c * power(x, a) * power(y, b);
      at.slope +=
          c * glm::dvec2(a * power(x, a - 1) * power(y, b), b * power(x, a) * power(y, b - 1));
      xx += c * a * (a - 1) * power(x, a - 2) * power(y, b);
      xy += c * a * b * power(x, a - 1) * power(y, b - 1);
      yy += c * b * (b - 1) * power(x, a) * power(y, b - 2);
    }
  }
  at.slope /= radius_m_;
  at.curvature_D = glm::dmat2(xx, xy, xy, yy) / (radius_m_ * radius_m_);
  return at;
}

Wavefront typicalWavefront(double age_years) {
  constexpr double kComa_um = 0.14, kTrefoil_um = 0.11, kSpherical_um = 0.13, kAll_um = 0.33;
  constexpr double kPerYear_um = 0.0032, kPupil_m = 6e-3, kAgeingPupil_m = 5e-3;
  const double scale = kAll_um / std::sqrt(kComa_um * kComa_um + kTrefoil_um * kTrefoil_um +
                                           kSpherical_um * kSpherical_um);
  Wavefront w{.zernike_um = std::vector<double>(13), .pupil_m = kPupil_m};
  w.zernike_um[6] = -scale * kTrefoil_um;
  w.zernike_um[7] = scale * kComa_um;
  w.zernike_um[12] = scale * kSpherical_um;
  const double at_ageing_um = rms_um(rescaled(w, kAgeingPupil_m), 3);
  const double aged = 1.0 + kPerYear_um * (age_years - kTypicalAge_years) / at_ageing_um;
  for (double& um : w.zernike_um) um *= aged;
  return w;
}

}  // namespace foci
