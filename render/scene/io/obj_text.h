// The text of an OBJ in the words that Assimp 5.2 reads. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

struct ObjText {
  std::string text;                  ///< the file as Assimp has to read it; empty: as it is
  std::vector<std::string> remarks;  ///< what the user should know
};

/// With 0.5 in place of .5 in its vertices, since Assimp takes a word that begins with a point for
/// none. Faces have no comment at their end, and those with two corners are lines. If floats would
/// lose the detail of the vertices, the origin is moved near the first one (scan_values.h), as
/// Assimp keeps floats.
/// @throws InputError if the last line is a face that is cut off: Assimp would leave it out
ObjText readableObj(const std::filesystem::path& obj);

}  // namespace foci
