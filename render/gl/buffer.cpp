#include "render/gl/buffer.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "base/text.h"

namespace foci {

GpuBuffer::~GpuBuffer() {
  if (id_ == 0) return;
  device_->later([id = id_] { glDeleteBuffers(1, &id); });
}

void GpuBuffer::reserve(GpuDevice& device, std::size_t bytes, const char* what, Kind kind) {
  if (bytes <= bytes_) return;
  constexpr double kMiB = 1024.0 * 1024.0;
  const auto needs = [&] {
    return device.name() + ": " + what + " need" + " " +
           decimal(static_cast<double>(bytes) / kMiB, 0) + " MiB of its memory";
  };
  if (kind == Kind::shader && bytes > device.maxBlock_bytes()) {
    throw GpuError(needs() + "; it allows " +
                   decimal(static_cast<double>(device.maxBlock_bytes()) / kMiB, 0) + " MiB");
  }
  device_ = &device;
  if (id_ != 0) glDeleteBuffers(1, &id_);
  bytes_ = 0;
  mapped_ = nullptr;
  while (glGetError() != GL_NO_ERROR) {
  }
  constexpr GLbitfield kMap = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  glCreateBuffers(1, &id_);
  glNamedBufferStorage(
      id_, static_cast<GLsizeiptr>(bytes), nullptr,
      kind == Kind::mapped ? kMap | GL_CLIENT_STORAGE_BIT : GLbitfield{GL_DYNAMIC_STORAGE_BIT});
  if (kind == Kind::mapped) {
    mapped_ = glMapNamedBufferRange(id_, 0, static_cast<GLsizeiptr>(bytes), kMap);
  }
  if (glGetError() != GL_NO_ERROR || (kind == Kind::mapped && !mapped_)) {
    throw GpuError(needs() + ", which has no such room left");
  }
  bytes_ = bytes;
}

void GpuBuffer::write(std::size_t from, std::size_t bytes, const void* data) {
  glNamedBufferSubData(id_, static_cast<GLintptr>(from), static_cast<GLsizeiptr>(bytes), data);
}

void GpuBuffer::fill(unsigned value, std::size_t bytes) {
  glClearNamedBufferSubData(id_, GL_R32UI, 0, static_cast<GLsizeiptr>(bytes), GL_RED_INTEGER,
                            GL_UNSIGNED_INT, &value);
}

void GpuBuffer::read(std::size_t from, std::size_t bytes, void* data) const {
  glGetNamedBufferSubData(id_, static_cast<GLintptr>(from), static_cast<GLsizeiptr>(bytes), data);
}

}  // namespace foci
