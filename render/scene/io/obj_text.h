// Rewrites an OBJ so that Assimp 5.2 reads it correctly. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string>

namespace foci {

struct ObjText {
  std::string text;    ///< the file as Assimp has to read it; empty: as it is
  std::string remark;  ///< what the user should know; empty: nothing
};

/// Writes 0.5 in place of .5 in the vertices, because Assimp does not read numbers that begin with
/// a point. If floats would lose the detail of the vertices, the origin is moved near the first
/// vertex (scan_values.h), because Assimp stores floats.
ObjText readableObj(const std::filesystem::path& obj);

}  // namespace foci
