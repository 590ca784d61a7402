// A bounding-sphere hierarchy over surfels (Rusinkiewicz and Levoy, QSplat, SIGGRAPH 2000) with the
// paper's low-passed texture (section 5.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// A surfel that replaces a range of surfels. Lengths are in metres, in the world frame.
///
/// The texture is low-passed: colour, opacity and basis are means, weighted by area. The basis
/// function r * q_l has the variance V_r + V_l (Eq. 12).
///   V_r = axis_u axis_u' + axis_v axis_v' is the mean of the surfels' own variances.
///   V_l = spread_u spread_u' + spread_v spread_v' is the spread of their positions, the filter
///   q_l.
/// Both lie in the plane of the mean normal. The shape is not low-passed: variance off the plane is
/// dropped.
struct PaperNode {
  glm::vec3 center_m;  ///< bounding sphere of the positions, each with the disc of its area
  float radius_m;
  glm::vec3 position_m;  ///< mean, weighted by area
  glm::vec3 axis_u_m, axis_v_m;
  glm::vec3 spread_u_m, spread_v_m;
  glm::vec3 color;
  float opacity;
  float area_m2;   ///< sum
  float widest_m;  ///< longest axis of any of its surfels
};

struct SurfelRange {
  std::size_t begin, end;
};

/// A complete tree in which each node has four children. Level l has 4^l nodes. Of n surfels, node
/// i replaces those at [i n / 4^l, (i + 1) n / 4^l) of `order()`, which are 1 to 4 surfels on the
/// last level. The node's children are 4 i to 4 i + 3 on the next level.
class PaperHierarchy {
 public:
  /// Splits at the median along the longest side, twice for each level: O(n log n), in parallel,
  /// with the same result at any number of threads. Leaves out surfels that are never visible: with
  /// values that are not finite, without area or without extent.
  explicit PaperHierarchy(const SurfelCloud& cloud);

  int levels() const { return static_cast<int>(first_.size()) - 1; }  ///< 0: nothing to render
  std::span<const PaperNode> level(int l) const {
    return {nodes_.data() + first_[l], nodes_.data() + first_[l + 1]};
  }
  SurfelRange surfels(int l, std::size_t node) const {
    const std::uint64_t n = order_.size();
    return {(node * n) >> (2 * l), ((node + 1) * n) >> (2 * l)};
  }
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  std::vector<PaperNode> nodes_;
  std::vector<std::size_t> first_;  // node of each level, and the end
  std::vector<std::uint32_t> order_;
};

}  // namespace foci
