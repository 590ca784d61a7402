// Recognises files that are no recording as text, by their first bytes ("magic").
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace foci {

/// What the file is and what to do with it; nothing if it may be a recording as text.
/// @param start  the first bytes of the file, unpacked; 64 are enough
/// @param name   its ending distinguishes formats without a magic number
std::optional<std::string> otherFileKind(std::string_view start, const std::filesystem::path& name);

/// @throws InputError if the file is no text that may hold gaze; a file that cannot be read passes
void requireGazeText(const std::filesystem::path& file);

}  // namespace foci
