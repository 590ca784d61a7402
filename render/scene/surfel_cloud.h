// The scene: oriented Gaussian surfels (EWA surface splatting, Zwicker et al. 2001).
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Surfels as a structure of arrays, all of the same length, in the world frame (metres,
/// right-handed, y up unless the study says otherwise).
///
/// Surfel k carries the Gaussian basis function with variance V_r = axis_u axis_u' + axis_v axis_v'
/// in its tangent plane: the axes are perpendicular, each one standard deviation long. The normal
/// is normalize(cross(axis_u, axis_v)). Its weight is `area_m2`, the surface area that it stands
/// for: with it the kernels of a well-sampled surface sum to one at every pixel (formulas.md,
/// section 2).
struct SurfelCloud {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> axis_u_m;
  std::vector<glm::vec3> axis_v_m;
  std::vector<glm::vec3> color;  ///< linear RGB, >= 0
  std::vector<float> opacity;    ///< 0 to 1; empty: all 1
  std::vector<float> area_m2;    ///< > 0

  /// The normals point out of the solid whose surface this is, or at least agree with their
  /// neighbours'. Then a surface that turns away from the eye is told from the one that turns
  /// towards it.
  bool oriented = false;

  std::size_t size() const { return position_m.size(); }
  bool empty() const { return position_m.empty(); }
};

/// Standard deviation of a surfel's basis over the local spacing of samples, sqrt(area of one
/// sample). On the paper's plane, sampled one surfel a pixel, it gives sqrt|V| = 1.38 px^2
/// (formulas.md, 7).
inline constexpr float kSigmaPerSpacing = 0.62f;

/// A unit vector across `normal`, which is one, too; the third is cross(normal, it).
inline glm::vec3 tangentTo(const glm::vec3& normal) {
  const glm::vec3 helper =
      std::abs(normal.x) < 0.5f ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  return glm::normalize(glm::cross(helper, normal));
}

/// An oriented circular surfel. `normal` of unit length; `sigma_m` one standard deviation.
/// Any colour, opacity: appended as they are.
void appendSurfel(SurfelCloud& cloud, const glm::vec3& position_m, const glm::vec3& normal,
                  float sigma_m, float area_m2, const glm::vec3& color, float opacity = 1.0f);

}  // namespace foci
