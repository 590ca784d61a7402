// Neon's native recording folder, as the Companion app writes it (docs.pupil-labs.com/neon).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// The files of a native recording that hold gaze: `gaze psN.raw`, `gaze psN.time` and, if there,
/// `worn psN.raw`, for N = 1, 2, ... Empty if `path` is no such folder, nor its `gaze ps1.raw`.
std::vector<std::filesystem::path> neonNativeFiles(const std::filesystem::path& path);

/// The gaze of a native recording as the table that Neon exports (CSV). `raw` begins each sample
/// with x and y as 32-bit floats, pixels of the scene camera; `time` has nanoseconds as 64-bit
/// integers; `worn` a byte, 0 where nobody wears the glasses.
/// @param path  as `neonNativeFiles` takes it
/// @throws InputError if the files do not belong together
std::string neonNativeTable(const std::filesystem::path& path);

}  // namespace foci
