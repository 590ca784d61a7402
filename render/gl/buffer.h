// A block of the GPU's memory.
#pragma once

#include <cstddef>
#include <utility>

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

  /// Makes room for `bytes` bytes, whose content is not set. Keeps a larger room. Throws GpuError
  /// if the driver has no such room, or no shader can see all of it.
  /// @param what  names the content in an error
  void reserve(GpuDevice& device, std::size_t bytes, const char* what);
  /// The same for a buffer of which shaders see a window at a time.
  void reserveWindowed(GpuDevice& device, std::size_t bytes, const char* what);
  /// The same for one that the CPU reads through `mapped`, and no shader.
  void reserveMapped(GpuDevice& device, std::size_t bytes, const char* what);
  void write(std::size_t from, std::size_t bytes, const void* data);
  void fill(unsigned value, std::size_t bytes);
  void read(std::size_t from, std::size_t bytes, void* data) const;

  unsigned id() const { return id_; }
  const void* mapped() const { return mapped_; }

 private:
  enum class Kind { shader, windowed, mapped };
  void make(GpuDevice& device, std::size_t bytes, const char* what, Kind kind);
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

}  // namespace foci
