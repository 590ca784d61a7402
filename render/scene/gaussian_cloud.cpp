#include "render/scene/gaussian_cloud.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/harmonics.h"

namespace foci {
namespace {

/// The orthogonal factor of a matrix (Higham, Computing the Polar Decomposition, 1986).
glm::mat3 orthogonalFactorOf(glm::mat3 matrix) {
  constexpr int kSteps = 24;
  constexpr float kSlack = 1e-5f;
  for (int step = 0; step < kSteps; ++step) {
    const glm::mat3 rest = matrix * glm::transpose(matrix) - glm::mat3(1.0f);
    if (glm::dot(rest[0], rest[0]) + glm::dot(rest[1], rest[1]) + glm::dot(rest[2], rest[2]) <
        kSlack * kSlack) {
      break;
    }
    matrix = 0.5f * (matrix + glm::inverse(glm::transpose(matrix)));
  }
  return matrix;
}

/// Turns the coefficients of colours that depend on the direction. A turned scene shows along R d
/// what it showed along d:
///   c'_i = sum over j of c_j M_ij,   M_ij = integral over the sphere of Y_i(d) Y_j(R^-1 d).
/// Degrees do not mix. The integral is exact: 4 Gauss-Legendre nodes by 8 angles hold for
/// polynomials of degree 7, and the product has 6.
class HarmonicsRotation {
 public:
  explicit HarmonicsRotation(const glm::mat3& rotation) {
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

  /// @param coefficients  of one Gaussian; rounded to the nearest step
  void turn(std::int16_t* coefficients, int degree) const {
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

 private:
  static constexpr std::size_t kCount = static_cast<std::size_t>(harmonicsOf(kMaxHarmonicsDegree));
  std::array<std::array<float, kCount>, kCount> matrix_{};
};

Covariance3 halfOf(const glm::mat3& symmetric) {
  const glm::mat3& m = symmetric;
  return {m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]};
}

}  // namespace

Covariance3 covarianceOf(const glm::vec3& sigma, const glm::vec4& rotation) {
  const glm::mat3 axes = glm::mat3_cast(glm::quat(rotation.w, rotation.x, rotation.y, rotation.z));
  return covarianceOf(glm::mat3(sigma.x * axes[0], sigma.y * axes[1], sigma.z * axes[2]));
}

Covariance3 covarianceOf(const glm::mat3& axes) { return halfOf(axes * glm::transpose(axes)); }

void append(GaussianCloud& to, const GaussianCloud& from) {
  const auto add = [](auto& all, const auto& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add(to.position_m, from.position_m);
  add(to.covariance_m2, from.covariance_m2);
  add(to.opacity, from.opacity);
  add(to.color, from.color);
  add(to.harmonics, from.harmonics);
}

void scaleBy(GaussianCloud& cloud, float factor) {
  if (factor == 1.0f) return;
  const float squared = factor * factor;
  parallelFor(cloud.size(), [&](std::size_t i) {
    cloud.position_m[i] *= factor;
    Covariance3& v = cloud.covariance_m2[i];
    for (float* each : {&v.xx, &v.xy, &v.xz, &v.yy, &v.yz, &v.zz}) *each *= squared;
  });
  if (!cloud.tree) return;
  const auto tree = std::make_shared<GaussianTree>(*cloud.tree);
  scaleBy(tree->nodes, factor);
  parallelFor(tree->radius_m.size(), [&](std::size_t node) {
    tree->radius_m[node] *= factor;
    tree->spread_m2[node] *= squared;
    tree->growth_per_m2[node] /= squared;
  });
  cloud.tree = tree;
}

void transform(GaussianCloud& cloud, const glm::mat3& linear, const glm::vec3& offset) {
  cloud.tree.reset();
  const bool moves_only = linear == glm::mat3(1.0f);
  std::optional<HarmonicsRotation> harmonics;
  if (cloud.degree > 0 && !moves_only) harmonics.emplace(orthogonalFactorOf(linear));
  const std::size_t each = cloud.harmonicsPerGaussian();
  parallelFor(cloud.size(), [&](std::size_t i) {
    cloud.position_m[i] = linear * cloud.position_m[i] + offset;
    if (moves_only) return;
    Covariance3& v = cloud.covariance_m2[i];
    v = halfOf(linear * matrixOf(v) * glm::transpose(linear));
    if (harmonics) harmonics->turn(cloud.harmonics.data() + i * each, cloud.degree);
  });
}

}  // namespace foci
