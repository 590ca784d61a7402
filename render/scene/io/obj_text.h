// Rewrites an OBJ so that Assimp 5.2 reads it correctly. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string_view>

#include "render/scene/io/mended_file.h"

namespace foci {

/// Rewrites what Assimp would misread. Numbers that begin with a point begin with 0. Faces have no
/// comment at their end, and those with two corners are lines. If floats would lose the detail of
/// the vertices, the origin is moved near the first vertex (scan_values.h), because Assimp stores
/// floats.
/// @throws InputError if the last line is a face that is cut off: Assimp would leave it out
MendedFile readableObj(const std::filesystem::path& obj);

/// The next word of a line of OBJ or MTL; empty at its end.
/// @param rest  of the line; loses the word and the blanks before it
std::string_view nextObjWord(std::string_view& rest);

}  // namespace foci
