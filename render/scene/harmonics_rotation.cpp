#include "render/scene/harmonics_rotation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/scene/harmonics.h"

namespace foci {

HarmonicsRotation::HarmonicsRotation(const glm::mat3& rotation) {
  constexpr std::array kNodes{0.3399810435848563, 0.8611363115940526};
  constexpr std::array kWeights{0.6521451548625461, 0.3478548451374538};
  constexpr int kAngles = 8;
  const glm::mat3 back = glm::transpose(rotation);
  for (int node = 0; node < 4; ++node) {
    const auto half = static_cast<std::size_t>(node / 2);
    const double z = (node % 2 == 0 ? 1.0 : -1.0) * kNodes[half], ring = std::sqrt(1.0 - z * z);
    const double weight = kWeights[half] * 2.0 * std::numbers::pi / kAngles;
    for (int k = 0; k < kAngles; ++k) {
      const double angle_rad = 2.0 * std::numbers::pi * k / kAngles;
      const glm::vec3 d(ring * std::cos(angle_rad), ring * std::sin(angle_rad), z);
      Harmonics after{}, before{};
      harmonicsIn(d, kMaxHarmonicsDegree, after);
      harmonicsIn(back * d, kMaxHarmonicsDegree, before);
      for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t j = 0; j < kCount; ++j) {
          matrix_[i][j] += static_cast<float>(weight) * after[i] * before[j];
        }
      }
    }
  }
}

void HarmonicsRotation::turn(std::int16_t* coefficients, int degree) const {
  const auto count = static_cast<std::size_t>(harmonicsOf(degree));
  std::array<std::int16_t, 3 * kCount> turned{};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      float sum = 0.0f;
      for (std::size_t j = 0; j < count; ++j) {
        sum += matrix_[i][j] * static_cast<float>(coefficients[3 * j + channel]);
      }
      constexpr float kMost = std::numeric_limits<std::int16_t>::max();
      turned[3 * i + channel] =
          static_cast<std::int16_t>(std::clamp(std::round(sum), -kMost, kMost));
    }
  }
  std::copy_n(turned.begin(), 3 * count, coefficients);
}

}  // namespace foci
