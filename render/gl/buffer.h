// A block of the GPU's memory.
#pragma once

#include <cstddef>
#include <utility>

#include "render/gl/device.h"

namespace foci {

/// Everything here needs a `GpuDevice::Use`.
class GpuBuffer {
 public:
  GpuBuffer() = default;
  GpuBuffer(GpuBuffer&& other) noexcept
      : id_(std::exchange(other.id_, 0)), bytes_(std::exchange(other.bytes_, 0)) {}
  GpuBuffer& operator=(GpuBuffer&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~GpuBuffer();

  /// Makes room for `bytes` bytes, whose content is not set. Keeps a larger room. Throws GpuError
  /// if the driver has no such room.
  /// @param what  names the content in an error
  void reserve(GpuDevice& device, std::size_t bytes, const char* what);
  void write(std::size_t from, std::size_t bytes, const void* data);
  void fill(unsigned value, std::size_t bytes);
  void read(std::size_t from, std::size_t bytes, void* data) const;

  unsigned id() const { return id_; }

 private:
  unsigned id_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace foci
