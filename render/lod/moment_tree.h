// Level of detail: a binary tree of surfels merged by their moments. Merging low-passes texture and
// shape alike (docs/formulas.md, section 4).
// A coarse outline of a large scene: where it is, and what it looks like from afar. It reads a few
// megabytes of the scene's file instead of all of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "render/lod/back_faces.h"
#include "render/scene/scene.h"
#include "render/scene/tree_order.h"

namespace foci {

/// Neighbouring surfels merged into one. Let w_i be area times opacity, x_i the positions, m their
/// weighted mean and V_i the variances. The node's variance is
///   sum w_i (V_i + (x_i - m)(x_i - m)') / sum w_i.
/// Seen along the unit vector d it covers density sqrt(d' adj(V) d), with the adjugate adj. For a
/// flat node this is its area times the cosine to its normal; else the cosine is a root mean
/// square.
struct alignas(64) LodNode {
  glm::vec3 position_m;
  float variance_m2[6];    ///< xx, xy, xz, yy, yz, zz
  glm::vec3 color;         ///< linear RGB, mean weighted by w
  float density;           ///< the area that is seen (`seenArea_m2`) over sqrt(trace adj(V))
  float radius_m;          ///< of a sphere about the position that holds all surfels to 3 sigma
  std::int16_t normal[2];  ///< mean normal, see `unpackNormal`
  std::uint16_t opacity;   ///< mean by area, in 65535ths
  /// The surfels' own share of the variance's trace, in 65535ths. Merging added the rest.
  std::uint16_t own;

  float trace_m2() const { return variance_m2[0] + variance_m2[3] + variance_m2[5]; }
  /// Variance that merging added, mean of two axes.
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

/// Sums over the surfels below a node.
struct NodeSums {
  double area = 0.0, weight = 0.0, opaque_area = 0.0;
  glm::dvec3 mean{0.0};
  double variance[6] = {};
  double own_trace = 0.0;
  glm::dvec3 color{0.0};
  glm::dvec3 normal{0.0};
  /// Of the surfels of closed bodies: their area, and the vector sum of areas times outer normals.
  double closed_area = 0.0;
  glm::dvec3 closed_facing{0.0};
  double radius = 0.0;  ///< about the mean
};

/// The area of the surfels, less that of the sides of closed bodies which hide behind others. Let A
/// be a surfel's area and n its normal. A closed body shows (sum A + |sum A n|) / 2: all of it
/// where the node has one side, half where it has both, never less than its larger side.
double seenArea_m2(const NodeSums& sums);

/// By node, the variance that merging added, with the variance along the mean normal counted
/// kThick times. A flat node has none along its normal. A node of two surfaces has a quarter of
/// their squared distance, or the variance that their angle makes. Such a node must be divided,
/// because the lens sees the two surfaces apart. kThick was chosen by hand.
struct Coarseness {
  float now_m2;  ///< of the node itself
  float min_m2;  ///< smallest of the clusters below the node, or the cluster itself
};

/// The nodes of a tree; the first of each array is unused. `facing` is empty without closed bodies.
struct TreeNodes {
  std::span<const LodNode> nodes;
  std::span<const Coarseness> coarseness;
  std::span<const Facing> facing;
};

/// A perfect binary tree over clusters of 3 to 6 surfels, or fewer in a tiny scene. Node i has the
/// children 2 i and 2 i + 1; the root is 1. Each split is at the median along the longest extent of
/// the positions. The tree takes less than 100 bytes a surfel, the surfels included.
class MomentTree {
 public:
  /// Deterministic at any number of threads. @param cloud  sound, fewer than 2^31 surfels
  explicit MomentTree(const SurfelCloud& cloud);
  /// A tree that was made before.
  /// @param surfels  in the tree's order
  /// @param nodes    2^`levelsOf(surfels.size())`, which `keep` keeps valid
  MomentTree(SurfelCloud surfels, const TreeNodes& nodes, std::shared_ptr<const void> keep);
  MomentTree(const MomentTree&) = delete;
  MomentTree& operator=(const MomentTree&) = delete;

  const SurfelCloud& surfels() const { return surfels_; }         ///< in the tree's own order
  std::span<const LodNode> nodes() const { return view_.nodes; }  ///< [0] is unused
  int levels() const { return levels_; }          ///< of nodes, >= 1; 0: an empty scene
  const NodeSums& sums() const { return sums_; }  ///< of the root, if the tree was made here

  std::span<const Coarseness> coarseness() const { return view_.coarseness; }  ///< by node
  static constexpr float kThick = 30.0f;

  /// By node; empty without closed bodies.
  std::span<const Facing> facing() const { return view_.facing; }

  bool isCluster(std::size_t node) const { return node >> (levels_ - 1) != 0; }

  /// The surfels [first, second) below the `j`-th node of a level. The root's level is 0; j begins
  /// at 0.
  std::pair<std::size_t, std::size_t> range(int level, std::size_t j) const {
    return rangeBelow(surfels_.size(), level, j);
  }

  /// Levels of the tree of `n` surfels.
  static int levelsOf(std::size_t n);

 private:
  void findFacing();

  SurfelCloud surfels_;
  std::vector<LodNode> nodes_;
  std::vector<Coarseness> coarseness_;
  std::vector<Facing> facing_;
  std::shared_ptr<const void> keep_;
  TreeNodes view_;
  NodeSums sums_;
  int levels_ = 0;
};

/// The nodes above the roots of 2^k trees, which lie side by side: node i has the children 2 i and
/// 2 i + 1, and the roots follow the last node.
struct TreeTop {
  std::vector<LodNode> nodes;  ///< 2^k; [0] is unused
  std::vector<Coarseness> coarseness;
};
struct TreeRoot {
  NodeSums sums;
  float min_m2;  ///< coarseness
};
TreeTop topOf(std::span<const TreeRoot> roots);

/// The surfels of a tree, with it. They lie in the tree until one of them changes.
SurfelCloud surfelsOf(std::shared_ptr<const MomentTree> tree);

/// The tree that a cloud came with, if all its surfels are still those of the tree; else null. What
/// it points to lives as long as the cloud.
std::shared_ptr<const MomentTree> builtTree(const SurfelCloud& cloud);

/// The cloud in the order of its tree, with the tree. The cloud itself where it has one.
SurfelCloud withTree(const SurfelCloud& cloud);

/// The same of a scene; absent for Gaussians.
std::optional<Scene> withSurfelTree(const Scene& scene);

/// The cloud's tree, or a new one.
std::shared_ptr<const MomentTree> treeOf(const SurfelCloud& cloud);

/// A scene with a tree counts as large if it has more surfels.
inline constexpr std::size_t kLargeScene = std::size_t{1} << 24;
bool isLarge(const Scene& scene);

/// The nodes of a middle level of the tree as round surfels. Each reaches as far as its node at
/// three standard deviations. Absent if the scene is not large, or has no tree.
std::optional<Scene> outlineOf(const Scene& scene, std::size_t large = kLargeScene);

}  // namespace foci
