#include "render/gl/texture.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <mutex>
#include <utility>

namespace foci {

struct GpuTextureStorage {
  explicit GpuTextureStorage(GpuDevice& on) : device(on) {}
  ~GpuTextureStorage() {
    device.later([id = id, written = written, shown = shown] {
      glDeleteTextures(1, &id);
      glDeleteSync(written);
      glDeleteSync(shown);
    });
  }
  GpuTextureStorage(const GpuTextureStorage&) = delete;
  GpuTextureStorage& operator=(const GpuTextureStorage&) = delete;

  GpuDevice& device;
  GLuint id = 0;
  glm::ivec2 size_px{0};
  GLsync written = nullptr, shown = nullptr;  // fences
};

namespace {

std::shared_ptr<GpuTextureStorage> storageOf(GpuDevice& device, const glm::ivec2& size_px) {
  const std::lock_guard lock(device.pool_mutex);
  auto& pool = device.texture_pool;
  for (const auto& each : pool) {
    if (each.use_count() == 1 && each->size_px == size_px) return each;
  }
  std::erase_if(pool, [](const auto& each) { return each.use_count() == 1; });
  auto made = std::make_shared<GpuTextureStorage>(device);
  made->size_px = size_px;
  glCreateTextures(GL_TEXTURE_2D, 1, &made->id);
  glTextureStorage2D(made->id, 1, GL_RGBA8, size_px.x, size_px.y);
  glTextureParameteri(made->id, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(made->id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  device.check();
  pool.push_back(made);
  return made;
}

}  // namespace

GpuTexture::GpuTexture(std::shared_ptr<GpuDevice> device, const glm::ivec2& size_px,
                       std::span<const GpuLayer> layers, std::optional<double> gamma)
    : device_(std::move(device)), storage_(storageOf(*device_, size_px)) {
  if (storage_->shown) {
    glWaitSync(storage_->shown, 0, GL_TIMEOUT_IGNORED);
    glDeleteSync(std::exchange(storage_->shown, nullptr));
  }
  glUseProgram(device_->program("encode"));
  glBindImageTexture(0, storage_->id, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  glUniform1f(3, gamma ? static_cast<float>(*gamma) : 0.0f);
  for (const GpuLayer& layer : layers) {
    constexpr int kGroup = 16;
    const glm::ivec2 size = layer.image->size_px(), groups = (size + kGroup - 1) / kGroup;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, layer.image->buffers().pixels.id());
    glUniform4i(0, size.x, size.y, layer.corner_px.x, layer.corner_px.y);
    glUniform2i(1, layer.columns, layer.white_column);
    glUniform3i(2, layer.channels.r, layer.channels.g, layer.channels.b);
    glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y), 1);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                    GL_TEXTURE_FETCH_BARRIER_BIT);
  }
  glDeleteSync(std::exchange(storage_->written, glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0)));
  glFlush();
  device_->check();
}

GpuTexture::~GpuTexture() {
  const std::lock_guard lock(device_->pool_mutex);
  storage_.reset();
}

glm::ivec2 GpuTexture::size_px() const { return storage_->size_px; }

unsigned GpuTexture::beginShow() {
  glWaitSync(storage_->written, 0, GL_TIMEOUT_IGNORED);
  return storage_->id;
}

void GpuTexture::endShow() {
  const std::lock_guard lock(device_->pool_mutex);
  // A headset and a window may show it at once: this fence follows that of the other.
  if (storage_->shown) glWaitSync(storage_->shown, 0, GL_TIMEOUT_IGNORED);
  glDeleteSync(std::exchange(storage_->shown, glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0)));
  glFlush();
}

}  // namespace foci
