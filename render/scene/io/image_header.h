// The size of an image file, from its first bytes. Private to the readers of meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace foci {

struct ImageSize {
  std::uint64_t columns = 0, rows = 0;
};

/// The size that a PNG, JPEG, BMP or WebP file states. A decoder takes memory for it before it
/// meets the end of a file that is too short. Absent for other formats and broken headers.
std::optional<ImageSize> statedImageSize(std::span<const unsigned char> bytes);

}  // namespace foci
