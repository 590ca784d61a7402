// Spherical harmonics that turn with their scene.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// Turns the coefficients of colours that depend on the direction. A turned scene shows along R d
/// what it showed along d:
///   c'_i = sum over j of c_j M_ij,   M_ij = integral over the sphere of Y_i(d) Y_j(R^-1 d).
/// Degrees do not mix. The integral is exact: 4 Gauss-Legendre nodes by 8 angles hold for
/// polynomials of degree 7, and the product has 6.
class HarmonicsRotation {
 public:
  explicit HarmonicsRotation(const glm::mat3& rotation);

  /// @param coefficients  of one Gaussian, red, green and blue of each harmonic, in steps of
  ///                      kHarmonicsStep; rounded to the nearest step
  void turn(std::int16_t* coefficients, int degree) const;

 private:
  static constexpr std::size_t kCount = static_cast<std::size_t>(harmonicsOf(kMaxHarmonicsDegree));
  std::array<std::array<float, kCount>, kCount> matrix_{};
};

}  // namespace foci
