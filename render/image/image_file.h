// Frames as files.
#pragma once

#include <filesystem>

#include "render/image/frame.h"

namespace foci {

/// Writes by extension: `.png` (8-bit sRGB), `.pfm` or `.exr` (linear float RGB). Written aside and
/// renamed.
/// @throws InputError for another extension, std::runtime_error where the file cannot be written
void writeImage(const std::filesystem::path& file, const Frame& frame);

/// Writes `frame.depth_m` as a one-channel float PFM, metres, 0 where nothing is seen.
void writeDepthPfm(const std::filesystem::path& file, const Frame& frame);

/// Throws InputError unless `writeImage` knows the extension: to refuse before rendering.
void checkImageExtension(const std::filesystem::path& file);

}  // namespace foci
