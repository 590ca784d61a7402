// The objects of a scene by surfel: what gaze meets.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/mapped_vector.h"

namespace foci {

/// Objects are numbered from 1; 0 is no object. Both are empty where the scene has no objects.
struct SceneObjects {
  MappedVector<std::uint16_t> of;  ///< by triangle, point or surfel
  std::vector<std::string> names;  ///< by number; [0] is ""

  bool empty() const { return of.empty(); }
};

/// Further objects count as none.
inline constexpr std::size_t kMaxObjects = 65535;

}  // namespace foci
