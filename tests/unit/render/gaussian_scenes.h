// Small scenes of Gaussians with known answers.
#pragma once

#include "render/scene/gaussian_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Appends a Gaussian without harmonics.
/// @param color  display value
inline void addGaussian(GaussianCloud& cloud, const glm::vec3& position_m, const glm::vec3& sigma_m,
                        float opacity, const glm::vec3& color,
                        const glm::vec4& rotation = {0.0f, 0.0f, 0.0f, 1.0f}) {
  cloud.position_m.push_back(position_m);
  cloud.covariance_m2.push_back(covarianceOf(sigma_m, rotation));
  cloud.opacity.push_back(opacity);
  cloud.color.push_back(color);
}

/// A square wall across the axis: `n` x `n` flat Gaussians that overlap.
inline void addWall(GaussianCloud& cloud, float depth_m, float size_m, int n, float opacity,
                    const glm::vec3& color) {
  const float h_m = size_m / static_cast<float>(n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      addGaussian(cloud,
                  {(static_cast<float>(x) + 0.5f) * h_m - 0.5f * size_m,
                   (static_cast<float>(y) + 0.5f) * h_m - 0.5f * size_m, -depth_m},
                  {kSigmaPerSpacing * h_m, kSigmaPerSpacing * h_m, 1e-5f}, opacity, color);
    }
  }
}

}  // namespace foci
