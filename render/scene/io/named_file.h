// Finds the files that a mesh names: materials, textures, buffers. Private to the readers of
// meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace foci {

/// The file that a name means. Blanks around the name and a pair of double quotes do not count, and
/// a backslash separates folders. A file of this very name comes first, seen from the folder of
/// `beside`; then one whose name and folders differ in case alone. Exporters also write paths of
/// the machine that they ran on. So a file of that name counts that lies beside, or in a folder
/// "textures" there. Absent if there is none.
/// @param beside  the file that has the name
std::optional<std::filesystem::path> namedFile(const std::filesystem::path& beside,
                                               std::string_view name);

/// The name without blanks and quotes around it, for messages.
std::string_view plainName(std::string_view name);

/// A URI as the name of a file: "%20" becomes a blank (RFC 3986).
std::string percentDecoded(std::string_view uri);

}  // namespace foci
