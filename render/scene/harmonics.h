// Real spherical harmonics up to degree 3, in the order and with the signs of captured scenes
// (Kerbl et al. 2023; Sloan, Efficient Spherical Harmonic Evaluation, JCGT 2(2), 2013).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// Y_0 = 1 / (2 sqrt(pi)): a coefficient of degree 0 times this is added to 0.5.
inline constexpr float kHarmonic0 = 0.28209479177387814f;

/// sqrt(3 / (4 pi)); sqrt(15 / (4 pi)), sqrt(5 / (16 pi)), sqrt(15 / (16 pi)); sqrt(35 / (32 pi)),
/// sqrt(105 / (4 pi)), sqrt(21 / (32 pi)), sqrt(7 / (16 pi)), sqrt(105 / (16 pi)).
inline constexpr float kHarmonic1 = 0.4886025119029199f;
inline constexpr float kHarmonic2a = 1.0925484305920792f, kHarmonic2b = 0.31539156525252005f,
                       kHarmonic2c = 0.5462742152960396f;
inline constexpr float kHarmonic3a = 0.5900435899266435f, kHarmonic3b = 2.890611442640554f,
                       kHarmonic3c = 0.4570457994644658f, kHarmonic3d = 0.3731763325901154f,
                       kHarmonic3e = 1.445305721320277f;

/// Y_1 to Y_15 in the unit direction `d`: 3 of degree 1, 5 of degree 2, 7 of degree 3, by order.
/// Degrees above `degree` are left unset.
using Harmonics = std::array<float, static_cast<std::size_t>(harmonicsOf(kMaxHarmonicsDegree))>;

inline void harmonicsIn(const glm::vec3& d, int degree, Harmonics& y) {
  if (degree < 1) return;
  y[0] = -kHarmonic1 * d.y;
  y[1] = kHarmonic1 * d.z;
  y[2] = -kHarmonic1 * d.x;
  if (degree < 2) return;
  const float xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
  y[3] = kHarmonic2a * d.x * d.y;
  y[4] = -kHarmonic2a * d.y * d.z;
  y[5] = kHarmonic2b * (2.0f * zz - xx - yy);
  y[6] = -kHarmonic2a * d.x * d.z;
  y[7] = kHarmonic2c * (xx - yy);
  if (degree < 3) return;
  y[8] = -kHarmonic3a * d.y * (3.0f * xx - yy);
  y[9] = kHarmonic3b * d.x * d.y * d.z;
  y[10] = -kHarmonic3c * d.y * (4.0f * zz - xx - yy);
  y[11] = kHarmonic3d * d.z * (2.0f * zz - 3.0f * xx - 3.0f * yy);
  y[12] = -kHarmonic3c * d.x * (4.0f * zz - xx - yy);
  y[13] = kHarmonic3e * d.z * (xx - yy);
  y[14] = -kHarmonic3a * d.x * (xx - 3.0f * yy);
}

/// Colour of Gaussian `i` seen along the unit direction `d`, from the eye: display values, >= 0.
inline glm::vec3 colorOf(const GaussianCloud& cloud, std::size_t i, const glm::vec3& d) {
  glm::vec3 color = cloud.color[i];
  if (cloud.degree > 0) {
    Harmonics y{};
    harmonicsIn(d, cloud.degree, y);
    const std::int16_t* coefficient = cloud.harmonics.data() + i * cloud.harmonicsPerGaussian();
    glm::vec3 sum(0.0f);
    for (std::size_t k = 0; k < static_cast<std::size_t>(harmonicsOf(cloud.degree)); ++k) {
      sum += y[k] * glm::vec3(coefficient[3 * k], coefficient[3 * k + 1], coefficient[3 * k + 2]);
    }
    color += kHarmonicsStep * sum;
  }
  return glm::max(color, glm::vec3(0.0f));
}

}  // namespace foci
