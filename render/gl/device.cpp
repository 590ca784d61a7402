#include "render/gl/device.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <utility>

#include "render/gl/shader_text.h"

namespace foci {

namespace {

/// Storage blocks that one stage uses at most.
constexpr int kStorageBlocks = 15;

std::string textOf(GLenum what) {
  const GLubyte* text = glGetString(what);
  return text ? reinterpret_cast<const char*>(text) : "";
}

bool isSoftwareRenderer(const std::string& name) {
  for (const std::string_view driver : {"llvmpipe", "softpipe", "swrast", "SWR"}) {
    if (name.find(driver) != std::string::npos) return true;
  }
  return false;
}

std::string firstLineOf(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

std::shared_ptr<GpuDevice> GpuDevice::open(Kind kind) {
  std::shared_ptr<GpuDevice> best;
  std::string problem;  // of the last device that does not suit
  openEglContexts(kind == Kind::any, [&](std::unique_ptr<GpuContext>& context) {
    try {
      auto device = std::make_shared<GpuDevice>(std::move(context));
      if (kind == Kind::hardware && device->isSoftware()) return true;
      if (!best || !device->isSoftware()) best = std::move(device);
    } catch (const GpuError& error) {
      problem = error.what();
      return true;
    }
    return best->isSoftware();
  });
  if (!best) {
    if (!problem.empty()) throw GpuError(problem);
    throw GpuError(kind == Kind::hardware
                       ? "no GPU with OpenGL 4.5"
                       : "no OpenGL 4.5 through EGL; on Debian: apt install libegl-mesa0");
  }
  return best;
}

GpuDevice::GpuDevice(std::unique_ptr<GpuContext> context) : context_(std::move(context)) {
  const Use use(*this);
  name_ = textOf(GL_RENDERER);
  driver_ = textOf(GL_VERSION);
  software_ = isSoftwareRenderer(name_);
  GLint major = 0, minor = 0, blocks = 0, alignment = 1;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (10 * major + minor < 45) {
    throw GpuError(name_ + " has OpenGL " + driver_ + ": expected version 4.5 or newer");
  }
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  glGetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &blocks);
  glGetIntegerv(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT, &alignment);
  max_block_bytes_ = static_cast<std::size_t>(bytes);
  block_alignment_bytes_ = static_cast<std::size_t>(std::max(alignment, 1));
  if (blocks < kStorageBlocks) {
    throw GpuError(name_ + " has " + std::to_string(blocks) + " storage blocks a shader, too few");
  }
}

GpuDevice::~GpuDevice() = default;

GpuDevice::Use::Use(GpuDevice& device) : device_(device), lock_(device.in_use_) {
  if (!device_.context_->makeCurrent()) {
    throw GpuError(device_.name_ + ": its OpenGL context is lost, or this thread has another one");
  }
  std::vector<std::function<void()>> actions;
  {
    const std::lock_guard lock(device_.later_mutex_);
    actions.swap(device_.later_);
  }
  for (const auto& action : actions) action();
}

GpuDevice::Use::~Use() { device_.context_->release(); }

void GpuDevice::later(std::function<void()> action) {
  const std::lock_guard lock(later_mutex_);
  later_.push_back(std::move(action));
}

void GpuDevice::check() const {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR) {
    throw GpuError(name_ + ": its OpenGL context was lost");
  }
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) throw GpuError(name_ + ": its memory is full");
  if (error == GL_CONTEXT_LOST) throw GpuError(name_ + ": its OpenGL context was lost");
  throw GpuError(name_ + ": its driver failed (OpenGL error " + std::to_string(error) + ")");
}

unsigned GpuDevice::program(const std::string& stage, const std::string& defines) {
  const std::string key = stage + '\n' + defines;
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;

  const std::string text = shaderText(stage, defines);
  const char* const source = text.c_str();
  const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  std::array<char, 2048> log{};
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  const GLuint program = glCreateProgram();
  if (good) {
    glAttachShader(program, shader);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    if (!good) glGetProgramInfoLog(program, log.size(), nullptr, log.data());
  } else {
    glGetShaderInfoLog(shader, log.size(), nullptr, log.data());
  }
  glDeleteShader(shader);
  if (!good) {
    glDeleteProgram(program);
    throw GpuError(name_ + ": its driver does not compile the shader " + stage + ": " +
                   firstLineOf(log.data()));
  }
  programs_.emplace(key, program);
  return program;
}

}  // namespace foci
