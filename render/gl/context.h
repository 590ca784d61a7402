// An OpenGL context that one thread at a time makes current.
#pragma once

#include <functional>
#include <memory>

namespace foci {

class GpuContext {
 public:
  GpuContext() = default;
  virtual ~GpuContext() = default;
  GpuContext(const GpuContext&) = delete;
  GpuContext& operator=(const GpuContext&) = delete;

  /// @return false: it is lost, or the thread has another context that cannot be replaced
  virtual bool makeCurrent() = 0;
  /// The thread has the context that it had before `makeCurrent`.
  virtual void release() = 0;
};

/// Opens contexts through EGL, which need neither a display nor a window, one after the other until
/// `wants` keeps one. They have OpenGL 4.5 or newer where the driver has it.
/// @param software  also contexts of drivers that render on the CPU
/// @param wants     moves from the context to keep it; returns whether to go on
void openEglContexts(bool software, const std::function<bool(std::unique_ptr<GpuContext>&)>& wants);

}  // namespace foci
