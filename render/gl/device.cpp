#include "render/gl/device.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "render/gl/shader_sources.h"
#include "render/kernel/limits.h"

namespace foci {
namespace {

/// Storage blocks that one stage uses at most.
constexpr int kStorageBlocks = 15;

/// A device that does not render in software, or may not.
bool mayBeHardware(EGLDeviceEXT device) {
  const auto query = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
      eglGetProcAddress("eglQueryDeviceStringEXT"));
  const char* extensions = query ? query(device, EGL_EXTENSIONS) : nullptr;
  return !extensions ||
         std::string_view(extensions).find("EGL_MESA_device_software") == std::string_view::npos;
}

/// The displays to try, in order.
std::vector<EGLDisplay> displays(GpuDevice::Kind kind) {
  std::vector<EGLDisplay> all;
  const auto query =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  const auto open = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (query && open) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (query(static_cast<EGLint>(devices.size()), devices.data(), &count)) {
      for (EGLint i = 0; i < count; ++i) {
        const EGLDeviceEXT device = devices.at(static_cast<std::size_t>(i));
        if (kind == GpuDevice::Kind::any || mayBeHardware(device)) {
          all.push_back(open(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        }
      }
    }
  }
  if (open && kind == GpuDevice::Kind::any) {
    all.push_back(open(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  }
  return all;
}

EGLContext contextOf(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return nullptr;
  constexpr std::array<EGLint, 7> kAttributes{EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_NONE};
  if (!eglBindAPI(EGL_OPENGL_API)) return nullptr;
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
}

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
  for (const EGLDisplay display : displays(kind)) {
    const EGLContext context = contextOf(display);
    if (!context) continue;
    const std::shared_ptr<GpuDevice> device(new GpuDevice);
    device->display_ = display;
    device->context_ = context;
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) continue;
    device->name_ = textOf(GL_RENDERER);
    device->driver_ = textOf(GL_VERSION);
    device->software_ = isSoftwareRenderer(device->name_);
    GLint64 bytes = 0;
    GLint blocks = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    glGetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &blocks);
    device->max_buffer_bytes_ = static_cast<std::size_t>(bytes);
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (blocks < kStorageBlocks || (kind == Kind::hardware && device->software_)) continue;
    if (!best || (best->software_ && !device->software_)) best = device;
    if (!best->software_) break;
  }
  if (!best) {
    throw GpuError(kind == Kind::hardware
                       ? "no GPU with OpenGL 4.5"
                       : "no OpenGL 4.5 through EGL; on Debian: apt install libegl-mesa0");
  }
  return best;
}

GpuDevice::~GpuDevice() {
  if (context_) eglDestroyContext(display_, context_);
}

GpuDevice::Use::Use(GpuDevice& device) : device_(device), lock_(device.in_use_) {
  if (!eglBindAPI(EGL_OPENGL_API) ||
      !eglMakeCurrent(device_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, device_.context_)) {
    throw GpuError(device_.name_ + ": its OpenGL context is lost, or this thread has another one");
  }
}

GpuDevice::Use::~Use() {
  eglMakeCurrent(device_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

unsigned GpuDevice::program(const std::string& stage, const std::string& defines) {
  const std::string key = stage + '\n' + defines;
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;

  const std::string head = "#version 450 core\n" + defines +
                           "const float kOverlap = " + std::to_string(kOverlap) + ";\n";
  std::vector<std::string> parts{head, shaderSource("frame"), shaderSource("totals")};
  if (stage == "sweep") parts.push_back(shaderSource("layers"));
  parts.push_back(shaderSource(stage));
  std::vector<const char*> texts;
  for (const std::string& part : parts) texts.push_back(part.c_str());

  const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
  glShaderSource(shader, static_cast<GLsizei>(texts.size()), texts.data(), nullptr);
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
