// The size of an image file, from its header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace foci {

struct ImageSize {
  std::uint64_t columns = 0, rows = 0;
};

/// The size that a PNG, JPEG, BMP, WebP or TIFF file states. A decoder takes memory for it before
/// it meets the end of a file that is too short. Absent for other formats and broken headers.
std::optional<ImageSize> statedImageSize(std::span<const unsigned char> bytes);

/// Of an image that foci decodes.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 26;

/// Refuses an image that states more, and a JPEG without its end: a decoder would only warn, and
/// fill the rest with grey. @throws InputError
void requireWholeImage(const std::filesystem::path& file);

}  // namespace foci
