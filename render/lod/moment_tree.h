// Level of detail: a binary tree of surfels merged by their moments, so that coarse levels have the
// texture and the shape of the surface low-passed alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Some neighbouring surfels as one. With w_i = area times opacity, m the mean of their positions
/// and V_i their variances, its variance is sum w_i (V_i + (x_i - m)(x_i - m)') / sum w_i. Seen
/// along the unit vector d it covers `density` sqrt(d' adj(V) d), adj the adjugate: for a flat node
/// its area times the cosine to its normal, else that with the root mean square of the cosines.
struct alignas(64) LodNode {
  glm::vec3 position_m;
  float variance_m2[6];    ///< xx, xy, xz, yy, yz, zz
  glm::vec3 color;         ///< linear RGB, mean weighted by w
  float density;           ///< sum of the areas over sqrt(trace adj(V))
  float radius_m;          ///< about the position: all of its surfels lie within, with 3 sigma
  std::int16_t normal[2];  ///< mean normal, see `unpackNormal`
  std::uint16_t opacity;   ///< mean by area, in 65535ths
  std::uint16_t own;  ///< share of the variance's trace that is the surfels' own, in 65535ths: the
                      ///< rest is what merging added

  float trace_m2() const { return variance_m2[0] + variance_m2[3] + variance_m2[5]; }
  /// What merging added to the variance, mean of two axes.
  float added_m2() const {
    return 0.5f * trace_m2() * (1.0f - static_cast<float>(own) * (1.0f / 65535.0f));
  }
  /// a' V b; the variance along `a` where `b` is `a`.
  float covariance_m2(const glm::vec3& a, const glm::vec3& b) const {
    const float* v = variance_m2;
    return a.x * b.x * v[0] + a.y * b.y * v[3] + a.z * b.z * v[5] +
           ((a.x * b.y + a.y * b.x) * v[1] + (a.x * b.z + a.z * b.x) * v[2] +
            (a.y * b.z + a.z * b.y) * v[4]);
  }
};
static_assert(sizeof(LodNode) == 64);

/// Unit vectors on an octahedron (Meyer et al. 2010), within 0.01 degrees.
void packNormal(const glm::vec3& normal, std::int16_t packed[2]);
glm::vec3 unpackNormal(const std::int16_t packed[2]);

/// A perfect binary tree over clusters of 3 to 6 surfels (fewer in a scene of fewer). Node i has
/// the children 2 i and 2 i + 1; the root is 1. Halves are
/// split at the median of the longest extent of the positions. Less than 100 bytes a surfel, the
/// surfels included.
class MomentTree {
 public:
  /// Deterministic at any number of threads. @param cloud  sound, fewer than 2^31 surfels
  explicit MomentTree(const SurfelCloud& cloud);

  const SurfelCloud& surfels() const { return surfels_; }       ///< in the tree's own order
  const std::vector<LodNode>& nodes() const { return nodes_; }  ///< nodes()[0] is unused
  int levels() const { return levels_; }  ///< of nodes, >= 1; 0: an empty scene

  /// By node, how coarse it is: what merging added to its variance, that along its mean normal
  /// counted kThick times. None of a flat node, that is, of one that holds two surfaces, which the
  /// lens tells apart, a quarter of their distance squared, or what their angle makes.
  struct Coarseness {
    float now_m2;
    float min_m2;  ///< of the clusters below it, itself if it is one
  };
  const std::vector<Coarseness>& coarseness() const { return coarseness_; }
  static constexpr float kThick = 30.0f;

  bool isCluster(std::size_t node) const { return node >> (levels_ - 1) != 0; }

  /// The surfels [first, second) of the `j`-th node, from 0, of a level, 0 that of the root.
  std::pair<std::size_t, std::size_t> range(int level, std::size_t j) const {
    return rangeOf(surfels_.size(), level, j);
  }

  /// The same of a tree of `n` surfels.
  static std::pair<std::size_t, std::size_t> rangeOf(std::uint64_t n, int level, std::size_t j) {
    return {n * j >> level, n * (j + 1) >> level};
  }

 private:
  SurfelCloud surfels_;
  std::vector<LodNode> nodes_;
  std::vector<Coarseness> coarseness_;
  int levels_ = 0;
};

}  // namespace foci
