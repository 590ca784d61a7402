// Rewrites an STL so that Assimp 5.2 reads it correctly. Private to the readers of meshes.
#pragma once

#include <filesystem>

#include "render/scene/io/mended_file.h"

namespace foci {

/// A text in capitals is in lower case. A binary file without bytes behind its triangles, and with
/// the colours of Magics as other programs write them: Assimp shows triangles that have the colour
/// of the header in black.
/// @throws InputError for a binary file that is cut off, or a text that ends within a triangle
MendedFile readableStl(const std::filesystem::path& stl);

}  // namespace foci
