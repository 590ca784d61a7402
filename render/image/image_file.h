// Frames as files.
#pragma once

#include <filesystem>
#include <optional>

#include "render/image/frame.h"

namespace foci {

/// Writes by extension: `.png` (8 bits, for a display of this gamma; absent: sRGB), `.pfm` or
/// `.exr` (linear float RGB). Written aside and renamed.
/// @throws InputError for another extension, std::runtime_error where the file cannot be written
void writeImage(const std::filesystem::path& file, const Frame& frame,
                std::optional<double> gamma = std::nullopt);

/// Writes `frame.depth_m` as a one-channel float PFM, metres, 0 where nothing is seen.
void writeDepthPfm(const std::filesystem::path& file, const Frame& frame);

/// Throws InputError unless `writeImage` knows the extension: to refuse before rendering.
void checkImageExtension(const std::filesystem::path& file);

}  // namespace foci
