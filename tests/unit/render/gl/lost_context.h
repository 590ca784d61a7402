// A GPU whose context is lost when a test says so.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include "render/gl/device.h"

namespace foci {

class LosableContext final : public GpuContext {
 public:
  LosableContext(std::unique_ptr<GpuContext> real, std::shared_ptr<std::atomic<bool>> lost)
      : real_(std::move(real)), lost_(std::move(lost)) {}
  bool makeCurrent() override { return !*lost_ && real_->makeCurrent(); }
  void release() override { real_->release(); }

 private:
  std::unique_ptr<GpuContext> real_;
  std::shared_ptr<std::atomic<bool>> lost_;
};

struct LosableDevice {
  std::shared_ptr<std::atomic<bool>> lost = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<GpuDevice> gpu;  ///< null where this machine has no OpenGL 4.5
};

inline LosableDevice losableDevice() {
  LosableDevice made;
  openEglContexts(true, [&](std::unique_ptr<GpuContext>& context) {
    try {
      made.gpu = std::make_shared<GpuDevice>(
          std::make_unique<LosableContext>(std::move(context), made.lost));
    } catch (const GpuError&) {
      return true;
    }
    return false;
  });
  return made;
}

}  // namespace foci
