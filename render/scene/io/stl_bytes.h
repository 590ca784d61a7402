// Rewrites a binary STL so that Assimp 5.2 reads it correctly. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string>

namespace foci {

/// The file with the colours of Magics as other programs write them: Assimp shows triangles that
/// have the colour of the header in black. Empty if nothing has to change.
/// @throws InputError for a binary file that is cut off
std::string readableStl(const std::filesystem::path& stl);

}  // namespace foci
