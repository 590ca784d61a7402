// Writes frames to image files.
#pragma once

#include <filesystem>
#include <optional>

#include "render/image/frame.h"

namespace foci {

/// Writes the format of the extension, `.png` (8 bits), `.pfm` or `.exr` (linear float RGB). The
/// file is written aside and renamed.
/// @param gamma  gamma of the display that a `.png` is for; absent: sRGB
/// @throws InputError for another extension, std::runtime_error if the file cannot be written
void writeImage(const std::filesystem::path& file, const Frame& frame,
                std::optional<double> gamma = std::nullopt);

/// Writes `frame.depth_m` as a one-channel float PFM, metres, 0 where there is no surface.
void writeDepthPfm(const std::filesystem::path& file, const Frame& frame);

/// Throws InputError unless `writeImage` knows the extension. Call it before rendering.
void checkImageExtension(const std::filesystem::path& file);

}  // namespace foci
