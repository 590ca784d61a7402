// Frames as they are shown: 8 bits, with a mark where the observer looks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"
#include "render/image/frame.h"

namespace foci {

/// @param gamma  of the display; absent: sRGB
Image imageOf(const Frame& frame, std::optional<double> gamma = std::nullopt);

/// A ring around a point, legible on any ground. Points off the image are left out.
/// @param held  the observer does not fixate now (saccade, blink, loss): the ring is broken
void drawMarker(Image& image, const glm::dvec2& point_px, bool held);

/// A smaller copy, `width_px` wide, of the same shape.
Image thumbnail(const Image& image, int width_px);

/// How much differences are amplified to be seen.
inline constexpr float kDifferenceGain = 8.0f;

/// How far two frames are apart, |a - b| times `gain`, linear. Same sizes.
Image differenceOf(const Frame& a, const Frame& b, float gain);

/// Images of one size in rows of equal length, a gap between them, the columns titled.
Image gridOf(const std::vector<std::vector<Image>>& rows, const std::vector<std::string>& titles);

/// As a JPEG file's bytes.
std::vector<std::uint8_t> jpegOf(const Image& image);

/// As a PNG file's bytes.
std::vector<std::uint8_t> pngOf(const Image& image);

}  // namespace foci
