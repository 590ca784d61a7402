// Fills buffers of the GPU from arrays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/gl/buffer.h"

namespace foci {

inline std::uint32_t packed(std::uint16_t low, std::uint16_t high) {
  return std::uint32_t{low} | std::uint32_t{high} << 16;
}

/// Fills a buffer in pieces, so that a copy of the whole never lies in memory. `make(i, to)` writes
/// the `width` vectors of element i.
template <typename Vector = glm::vec4, typename Make>
void upload(GpuDevice& device, GpuBuffer& buffer, std::size_t count, std::size_t width,
            const char* what, bool windowed, const Make& make) {
  constexpr std::size_t kPiece = 1 << 16;
  const std::size_t each_bytes = width * sizeof(Vector);
  const std::size_t bytes = std::max<std::size_t>(count, 1) * each_bytes;
  if (windowed) {
    buffer.reserveWindowed(device, bytes, what);
  } else {
    buffer.reserve(device, bytes, what);
  }
  std::vector<Vector> piece(kPiece * width);
  for (std::size_t first = 0; first < count; first += kPiece) {
    const std::size_t some = std::min(kPiece, count - first);
    for (std::size_t i = 0; i < some; ++i) make(first + i, piece.data() + width * i);
    buffer.write(first * each_bytes, some * each_bytes, piece.data());
  }
}

}  // namespace foci
