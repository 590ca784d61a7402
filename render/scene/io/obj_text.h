// The text of an OBJ in the words that Assimp 5.2 reads. Private to the readers of meshes.
#pragma once

#include <filesystem>

#include "render/scene/io/mended_file.h"

namespace foci {

/// With 0.5 in place of .5 in its vertices, since Assimp takes a word that begins with a point for
/// none. Faces have no comment at their end, and those with two corners are lines. If floats would
/// lose the detail of the vertices, the origin is moved near the first one (scan_values.h), as
/// Assimp keeps floats.
/// @throws InputError if the last line is a face that is cut off: Assimp would leave it out
MendedFile readableObj(const std::filesystem::path& obj);

}  // namespace foci
