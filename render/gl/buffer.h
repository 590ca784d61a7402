// Blocks of the GPU's memory, and windows of those that are larger than a shader can address.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "render/gl/device.h"

namespace foci {

/// Everything here but the destructor needs a `GpuDevice::Use`. The device outlives the buffer.
class GpuBuffer {
 public:
  GpuBuffer() = default;
  GpuBuffer(GpuBuffer&& other) noexcept { swap(other); }
  GpuBuffer& operator=(GpuBuffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~GpuBuffer();

  /// Shaders see all of it, or a window at a time, or none: the CPU reads it through `mapped`.
  enum class Kind { shader, windowed, mapped };
  /// Makes room for `bytes` bytes, whose content is not set. Keeps a larger room. Throws GpuError
  /// if the driver has no such room, or no shader can see all of it.
  /// @param what  names the content in an error
  void reserve(GpuDevice& device, std::size_t bytes, const char* what, Kind kind = Kind::shader);
  void write(std::size_t from, std::size_t bytes, const void* data);
  void fill(unsigned value, std::size_t bytes);
  void read(std::size_t from, std::size_t bytes, void* data) const;

  unsigned id() const { return id_; }
  const void* mapped() const { return mapped_; }

 private:
  void swap(GpuBuffer& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    std::swap(mapped_, other.mapped_);
  }

  GpuDevice* device_ = nullptr;
  unsigned id_ = 0;
  std::size_t bytes_ = 0;
  const void* mapped_ = nullptr;
};

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
  buffer.reserve(device, bytes, what,
                 windowed ? GpuBuffer::Kind::windowed : GpuBuffer::Kind::shader);
  std::vector<Vector> piece(kPiece * width);
  for (std::size_t first = 0; first < count; first += kPiece) {
    const std::size_t some = std::min(kPiece, count - first);
    for (std::size_t i = 0; i < some; ++i) make(first + i, piece.data() + width * i);
    buffer.write(first * each_bytes, some * each_bytes, piece.data());
  }
}

/// Elements of an array that a shader can address.
struct GpuWindow {
  std::size_t first = 0, count = 0;
};

/// Elements in a window. Each window begins where the driver lets it.
inline std::size_t windowSize(const GpuDevice& device, std::size_t each_bytes) {
  const std::size_t step = device.blockAlignment_bytes();
  return std::max(device.maxBlock_bytes() / each_bytes / step, std::size_t{1}) * step;
}

/// The `i`-th window of an array of `all` elements; empty beyond the last one.
inline GpuWindow windowOf(const GpuDevice& device, std::size_t i, std::size_t each_bytes,
                          std::size_t all) {
  const std::size_t size = windowSize(device, each_bytes), first = std::min(i * size, all);
  return {first, std::min(size, all - first)};
}

/// Windows until all elements have been seen.
inline std::size_t windowsOver(const GpuDevice& device, std::size_t each_bytes, std::size_t all) {
  const std::size_t size = windowSize(device, each_bytes);
  return (all + size - 1) / size;
}

}  // namespace foci
