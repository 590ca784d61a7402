// Windows of arrays that are larger than a shader can address.
#pragma once

#include <algorithm>
#include <cstddef>

#include "render/gl/device.h"

namespace foci {

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
