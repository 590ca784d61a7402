// A bounding-sphere hierarchy over surfels (QSplat: Rusinkiewicz and Levoy 2000) with the paper's
// low-passed texture (section 5.3). Private to `paper-lod`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// A surfel that stands for those of a range: lengths in metres, world frame.
///
/// The texture is low-passed: colour, opacity and basis are means by area, and the basis function
/// r * q_l has the variance V_r + V_l (Eq. 12), both in the plane of the mean normal:
///   V_r = axis_u axis_u' + axis_v axis_v'          mean of the surfels' own
///   V_l = spread_u spread_u' + spread_v spread_v'  spread of their positions: the filter q_l
/// The shape is not: what lies off the plane is dropped.
struct PaperNode {
  glm::vec3 center_m;  ///< bounding sphere of the positions, each with the disc of its area
  float radius_m;
  glm::vec3 position_m;  ///< mean by area
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

/// Complete tree of four children a node. Level l has 4^l nodes; node i of n surfels stands for
/// those at [i n / 4^l, (i + 1) n / 4^l) of `order()`: 1 to 4 on the last level. Its children are
/// 4 i to 4 i + 3 on the next.
class PaperHierarchy {
 public:
  /// Halves by the median along the longest side, twice a level: O(n log n), in parallel, the same
  /// at any number of threads. Surfels that never render anything (not finite, without area or
  /// extent) are left out.
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
  std::vector<std::size_t> first_;  // of each level; one more
  std::vector<std::uint32_t> order_;
};

}  // namespace foci
