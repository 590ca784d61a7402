// Points as they were measured, before surfels are estimated from them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Points as they were measured, as a structure of arrays. `position_m` and `color` have one entry
/// a point; each of the others has one a point or, where nobody said, none at all.
struct PointCloud {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> normal;  ///< unit length; (0, 0, 0): to be estimated
  std::vector<glm::vec3> color;   ///< linear RGB; mid-grey where the file has none
  std::vector<float> radius_m;  ///< of a disc that reaches across the gaps, > 0; 0: to be estimated
  std::vector<float> opacity;   ///< 0 to 1
  std::size_t dropped = 0;      ///< points left out since their position was not finite

  std::size_t size() const { return position_m.size(); }
};

}  // namespace foci
