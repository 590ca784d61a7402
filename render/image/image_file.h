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

/// Writes one float a pixel, as PFM or EXR after the extension (`.pfm`, `.exr`).
/// @param values  in rows from the top
void writeMap(const std::filesystem::path& file, const glm::ivec2& size_px,
              const std::vector<float>& values);

/// Throws InputError unless `writeImage` knows the extension. Call it before rendering.
void checkImageExtension(const std::filesystem::path& file);

}  // namespace foci
