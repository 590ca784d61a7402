// Oriented Gaussian surfels (EWA surface splatting, Zwicker et al. 2001), the closed bodies that
// they cover, and the objects that gaze meets.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/mapped_vector.h"

namespace foci {

class MomentTree;
struct SurfelCloud;
struct TriangleMesh;

/// The closed bodies of a cloud, numbered from 1: opaque solids whose surface has no hole. From
/// outside, the near side hides the far side, so nothing that faces away from the eye need be
/// rendered (render/lod/back_faces.h).
struct ClosedBodies {
  struct Box {
    glm::vec3 low_m, high_m;
  };
  MappedVector<std::uint16_t> of_surfel;  ///< 0: none. Empty: no surfel is on a closed body
  std::vector<Box> boxes;                 ///< by number; [0] is unused. Empty where `of_surfel` is
};

/// Largest number of a body. Further surfaces count as open.
inline constexpr std::uint16_t kMaxBodies = 65534;

/// Makes the boxes of `cloud.bodies` from the surfels' extents to three standard deviations. Drops
/// bodies of which a surfel is not opaque.
void completeBodies(SurfelCloud& cloud);

/// Objects are numbered from 1; 0 is no object. Both are empty where the scene has no objects.
struct SceneObjects {
  MappedVector<std::uint16_t> of;  ///< by triangle, point or surfel
  std::vector<std::string> names;  ///< by number; [0] is ""

  bool empty() const { return of.empty(); }
};

/// Further objects count as none.
inline constexpr std::size_t kMaxObjects = 65535;

/// The tree over a cloud's surfels (`builtTree` in render/lod/moment_tree.h). It shares its arrays
/// with the cloud. Once code changes a surfel, the cloud has an array of its own, so the tree no
/// longer counts: nobody has to remember to reset it.
class BuiltTree {
 public:
  BuiltTree() = default;

 private:
  friend SurfelCloud surfelsOf(std::shared_ptr<const MomentTree> tree);
  friend std::shared_ptr<const MomentTree> builtTree(const SurfelCloud& cloud);
  explicit BuiltTree(std::shared_ptr<const MomentTree> tree) : tree_(std::move(tree)) {}

  std::shared_ptr<const MomentTree> tree_{};
};

/// Surfels as a structure of arrays, all of the same length. The world frame is in metres,
/// right-handed, y up unless the study says otherwise.
///
/// Surfel k has a Gaussian basis function of variance V_r = axis_u axis_u' + axis_v axis_v' in its
/// tangent plane. The axes are perpendicular, each one standard deviation long. The normal is
/// normalize(cross(axis_u, axis_v)). The weight `area_m2` is the surfel's share of the surface
/// area. With these weights the kernels of a well-sampled surface sum to one at every pixel
/// (docs/formulas.md, section 2).
struct SurfelCloud {
  static constexpr const char* kNoun = "surfels";

  MappedVector<glm::vec3> position_m;
  MappedVector<glm::vec3> axis_u_m;
  MappedVector<glm::vec3> axis_v_m;
  MappedVector<glm::vec3> color;  ///< linear RGB, >= 0
  MappedVector<float> opacity;    ///< 0 to 1; empty: all 1
  MappedVector<float> area_m2;    ///< > 0

  /// Normals point out of the solid, or at least agree with their neighbours'. The renderer then
  /// distinguishes back-facing surfels from those that face the eye.
  bool oriented = false;

  /// Which surfels lie on closed bodies; their normals point outwards.
  ClosedBodies bodies = {};

  SceneObjects objects = {};  ///< by surfel

  BuiltTree tree = {};

  /// The mesh that the surfels were sampled from; null if they are all that is known.
  std::shared_ptr<const TriangleMesh> mesh = {};

  std::size_t size() const { return position_m.size(); }
  bool empty() const { return position_m.empty(); }
};

inline float opacityOf(const SurfelCloud& cloud, std::size_t i) {
  return cloud.opacity.empty() ? 1.0f : cloud.opacity[i];
}

/// Standard deviation of a surfel's basis along its longer axis.
float largestSigma(const SurfelCloud& cloud, std::size_t i);

/// The least and the greatest coordinates of places, not empty.
std::pair<glm::vec3, glm::vec3> boxOf(std::span<const glm::vec3> places);

/// Standard deviation of a surfel's basis over the local spacing of samples, sqrt(area of one
/// sample). On the paper's plane, with one surfel a pixel, it gives the paper's sqrt|V| = 1.38 px^2
/// (docs/formulas.md, section 7).
inline constexpr float kSigmaPerSpacing = 0.62f;

/// A unit vector u perpendicular to the unit vector `normal`. With cross(normal, u) the three form
/// a basis.
inline glm::vec3 tangentTo(const glm::vec3& normal) {
  const glm::vec3 helper =
      std::abs(normal.x) < 0.5f ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  return glm::normalize(glm::cross(helper, normal));
}

/// Appends a circular surfel. `normal` has unit length, `sigma_m` is one standard deviation. Colour
/// and opacity are not checked.
void appendSurfel(SurfelCloud& cloud, const glm::vec3& position_m, const glm::vec3& normal,
                  float sigma_m, float area_m2, const glm::vec3& color, float opacity = 1.0f);

}  // namespace foci
