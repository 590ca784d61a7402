#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <string_view>
#include <vector>

#include "render/gl/device.h"

namespace foci {
namespace {

class EglContext final : public GpuContext {
 public:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
  ~EglContext() override { eglDestroyContext(display_, context_); }
  bool makeCurrent() override {
    return eglBindAPI(EGL_OPENGL_API) &&
           eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  void release() override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  NativeGl native() const override {
    return {.egl = true, .display = display_, .context = context_};
  }

 private:
  EGLDisplay display_;
  EGLContext context_;
};

/// A device that does not render in software, or may not.
bool mayBeHardware(EGLDeviceEXT device) {
  const auto query = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
      eglGetProcAddress("eglQueryDeviceStringEXT"));
  const char* extensions = query ? query(device, EGL_EXTENSIONS) : nullptr;
  return !extensions ||
         std::string_view(extensions).find("EGL_MESA_device_software") == std::string_view::npos;
}

/// The displays to try, in order.
std::vector<EGLDisplay> displays(bool software) {
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
        if (software || mayBeHardware(device)) {
          all.push_back(open(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        }
      }
    }
  }
  if (open && software) all.push_back(open(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  return all;
}

EGLContext contextOf(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return nullptr;
  if (!eglBindAPI(EGL_OPENGL_API)) return nullptr;
  // The driver tells of a loss where it can: without it, a lost context fails in silence.
  constexpr std::array<EGLint, 9> kAttributes{EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                              EGL_LOSE_CONTEXT_ON_RESET,
                                              EGL_NONE};
  if (const EGLContext context =
          eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data())) {
    return context;
  }
  std::array<EGLint, 9> silent = kAttributes;
  silent[6] = EGL_NONE;
  if (const EGLContext context =
          eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, silent.data())) {
    return context;
  }
  // An older version, so that a message can name the driver.
  constexpr std::array<EGLint, 1> kAny{EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAny.data());
}

}  // namespace

void openEglContexts(bool software,
                     const std::function<bool(std::unique_ptr<GpuContext>&)>& wants) {
  for (const EGLDisplay display : displays(software)) {
    const EGLContext context = contextOf(display);
    if (!context) continue;
    std::unique_ptr<GpuContext> opened = std::make_unique<EglContext>(display, context);
    if (!wants(opened)) return;
  }
}

}  // namespace foci
