// Frames as 8-bit images, markers, and image files.
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

/// All bytes are `value`.
Image filledImage(const glm::ivec2& size_px, std::uint8_t value);

/// Draws a ring around a point, visible on any ground. A point outside the image gets no ring.
/// @param broken  draws a broken ring: the observer does not fixate now
void drawMarker(Image& image, const glm::dvec2& point_px, bool broken);

/// Makes black all that `drawMarker` may have drawn.
void eraseMarker(Image& image, const glm::dvec2& point_px);

/// Reads an EXR (linear light) or a PNG (sRGB, 8 or 16 bits). Alpha is left out. A file of one
/// channel is grey.
/// @throws InputError for another extension, a file that cannot be read, and values that are not
/// finite
Frame readImage(const std::filesystem::path& file);

/// A smaller copy, `width_px` wide, of the same shape.
Image thumbnail(const Image& image, int width_px);

/// Factor that makes differences visible; chosen by eye.
inline constexpr float kDifferenceGain = 8.0f;

/// |a - b| times `gain`, linear. The frames have the same size.
Image differenceOf(const Frame& a, const Frame& b, float gain);

/// A grid of images of one size, with gaps and column titles. The rows have equal length.
Image gridOf(const std::vector<std::vector<Image>>& rows, const std::vector<std::string>& titles);

/// The bytes of a JPEG file.
std::string jpegOf(const Image& image);

/// The bytes of a PNG file.
std::string pngOf(const Image& image);

/// The image of a PNG file's bytes; an empty one unless they state this size. A larger one is not
/// unpacked.
Image imageOfPng(const std::string& bytes, const glm::ivec2& size_px);

}  // namespace foci
