#include "render/scene/gaussian_transform.h"

#include <optional>

#include "base/parallel.h"
#include "render/scene/harmonics_rotation.h"

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

}  // namespace

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
    const glm::mat3 matrix(v.xx, v.xy, v.xz, v.xy, v.yy, v.yz, v.xz, v.yz, v.zz);
    const glm::mat3 out = linear * matrix * glm::transpose(linear);
    v = {out[0][0], out[0][1], out[0][2], out[1][1], out[1][2], out[2][2]};
    if (harmonics) harmonics->turn(cloud.harmonics.data() + i * each, cloud.degree);
  });
}

}  // namespace foci
