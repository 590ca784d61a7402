#include "render/scene/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace foci {
namespace FOCI_FILE {

/// The associated Legendre polynomial P_l^m(x), m >= 0, without the phase (-1)^m.
double legendre(int l, int m, double x) {
  double before = 0.0, now = 1.0;
  for (int i = 1; i <= m; ++i) now *= (2 * i - 1) * std::sqrt(1.0 - x * x);
  for (int i = m + 1; i <= l; ++i) {
    const double next = ((2 * i - 1) * x * now - (i + m - 1) * before) / (i - m);
    before = now;
    now = next;
  }
  return now;
}

/// The real spherical harmonic with the phase (-1)^m.
double harmonic(int l, int m, const glm::dvec3& d) {
  const int size = std::abs(m);
  double ratio = 1.0;  // (l - |m|)! / (l + |m|)!
  for (int i = l - size + 1; i <= l + size; ++i) ratio /= i;
  const double k = std::sqrt((2 * l + 1) / (4.0 * M_PI) * ratio);
  const double phi = std::atan2(d.y, d.x);
  const double turn = m == 0 ? 1.0
                             : std::sqrt(2.0) * (size % 2 == 0 ? 1.0 : -1.0) *
                                   (m < 0 ? std::sin(size * phi) : std::cos(size * phi));
  return k * turn * legendre(l, size, d.z);
}

glm::dvec3 directionOf(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
}

TEST(Harmonics, EqualTheirDefinition) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 d = directionOf(random);
    Harmonics y{};
    harmonicsIn(glm::vec3(d), 3, y);
    std::size_t k = 0;
    for (int l = 1; l <= 3; ++l) {
      for (int m = -l; m <= l; ++m) EXPECT_NEAR(y[k++], harmonic(l, m, d), 1e-5) << l << ' ' << m;
    }
  }
  EXPECT_NEAR(kHarmonic0, harmonic(0, 0, {0.0, 0.0, 1.0}), 1e-7);
}

TEST(Harmonics, GiveTheColourOfAGaussian) {
  std::mt19937 random(2);
  for (int degree = 0; degree <= kMaxHarmonicsDegree; ++degree) {
    GaussianCloud cloud;
    cloud.degree = degree;
    cloud.position_m.resize(1);
    cloud.color.emplace_back(0.6f, 0.5f, 0.4f);
    for (std::size_t i = 0; i < cloud.harmonicsPerGaussian(); ++i) {
      cloud.harmonics.push_back(static_cast<std::int16_t>(static_cast<int>(random() % 801) - 400));
    }
    for (int i = 0; i < 20; ++i) {
      const glm::dvec3 d = directionOf(random);
      glm::dvec3 expected(cloud.color[0]);
      std::size_t k = 0;
      for (int l = 1; l <= degree; ++l) {
        for (int m = -l; m <= l; ++m, k += 3) {
          expected +=
              harmonic(l, m, d) * double{kHarmonicsStep} *
              glm::dvec3(cloud.harmonics[k], cloud.harmonics[k + 1], cloud.harmonics[k + 2]);
        }
      }
      const glm::vec3 color = colorOf(cloud, 0, glm::vec3(d));
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(color[channel], std::max(expected[channel], 0.0), 1e-5);
      }
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
