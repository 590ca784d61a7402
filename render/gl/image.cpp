#include "render/gl/image.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <mutex>
#include <utility>

#include "render/gl/shader_text.h"

namespace foci {
namespace {

std::size_t pixelsOf(const glm::ivec2& size_px) {
  return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
}

std::shared_ptr<GpuImageBuffers> buffersOf(GpuDevice& device, const glm::ivec2& size_px,
                                           bool depth) {
  const std::lock_guard lock(device.pool_mutex);
  auto& pool = device.image_pool;
  for (const auto& each : pool) {
    if (each.use_count() == 1 && each->size_px == size_px && each->depth == depth) return each;
  }
  std::erase_if(pool, [](const auto& each) { return each.use_count() == 1; });
  auto made = std::make_shared<GpuImageBuffers>();
  made->size_px = size_px;
  made->depth = depth;
  const std::size_t pixels = std::max<std::size_t>(pixelsOf(size_px), 1);
  made->pixels.reserve(device, pixels * sizeof(glm::vec4), "the image's pixels");
  if (depth) made->depths.reserve(device, pixels * sizeof(float), "the image's depths");
  pool.push_back(made);
  return made;
}

}  // namespace

GpuImage::GpuImage(std::shared_ptr<GpuDevice> device, const glm::ivec2& size_px, bool depth)
    : device_(std::move(device)), buffers_(buffersOf(*device_, size_px, depth)) {}

GpuImage::~GpuImage() {
  if (copied_) device_->later([fence = copied_] { glDeleteSync(static_cast<GLsync>(fence)); });
  const std::lock_guard lock(device_->pool_mutex);
  buffers_.reset();
}

void GpuImage::startRead() {
  if (copied_) return;
  const std::size_t pixels = std::max<std::size_t>(pixelsOf(size_px()), 1);
  const auto copy = [&](const GpuBuffer& from, GpuBuffer& to, std::size_t bytes) {
    to.reserve(*device_, bytes, "the copies of an image", GpuBuffer::Kind::mapped);
    glCopyNamedBufferSubData(from.id(), to.id(), 0, 0, static_cast<GLsizeiptr>(bytes));
  };
  copy(buffers_->pixels, buffers_->host_pixels, pixels * sizeof(glm::vec4));
  if (hasDepth()) copy(buffers_->depths, buffers_->host_depths, pixels * sizeof(float));
  copied_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
}

void GpuImage::finishRead() {
  assert(copied_);
  constexpr GLuint64 kWait_ns = 1'000'000'000;
  GLenum state = GL_TIMEOUT_EXPIRED;
  while (state == GL_TIMEOUT_EXPIRED) {  // a frame of the software driver may take minutes
    device_->check();
    state = glClientWaitSync(static_cast<GLsync>(copied_), GL_SYNC_FLUSH_COMMANDS_BIT, kWait_ns);
  }
  device_->check();
  if (state == GL_WAIT_FAILED) throw GpuError(device_->name() + ": its driver failed");
}

void GpuImage::copyTo(Frame& frame) const {
  frame.resize(size_px(), hasDepth());
  std::memcpy(frame.rgba.data(), buffers_->host_pixels.mapped(),
              frame.rgba.size() * sizeof frame.rgba[0]);
  if (!hasDepth()) return;
  std::memcpy(frame.depth_m.data(), buffers_->host_depths.mapped(),
              frame.depth_m.size() * sizeof frame.depth_m[0]);
}

void GpuImage::add(const GpuImage& image, const glm::vec4& share, bool replaces) {
  assert(image.size_px() == size_px() && !copied_);
  glUseProgram(device_->program("sum", replaces ? "#define REPLACES\n" : ""));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, image.buffers().pixels.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers_->pixels.id());
  const auto pixels = static_cast<GLuint>(pixelsOf(size_px()));
  glUniform4f(0, share.r, share.g, share.b, share.a);
  glUniform1ui(1, pixels);
  const glm::uvec4 rows = rowsOf(groupsOf(pixels, 256));
  glDispatchCompute(rows.x, rows.y, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void readFromGpu(Frame& frame) {
  if (!frame.gpu) return;
  {
    const GpuDevice::Use use(*frame.gpu->device());
    frame.gpu->startRead();
    frame.gpu->finishRead();
  }
  frame.gpu->copyTo(frame);
  frame.gpu.reset();
}

void addOnGpu(const Frame& frame, const glm::vec4& share, bool first, Frame& sum) {
  const GpuDevice::Use use(*frame.gpu->device());
  if (first) sum.gpu = std::make_shared<GpuImage>(frame.gpu->device(), frame.gpu->size_px(), false);
  sum.gpu->add(*frame.gpu, share, first);
}

}  // namespace foci
