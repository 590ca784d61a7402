// The device of the tests that render on a GPU: one for all, because its shaders take a while to
// compile.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "render/gl/device.h"

namespace foci {

/// Null where this machine has no OpenGL 4.5, not even in software.
inline std::shared_ptr<GpuDevice> testDevice() {
  static const std::shared_ptr<GpuDevice> device = []() -> std::shared_ptr<GpuDevice> {
    try {
      return GpuDevice::open(GpuDevice::Kind::any);
    } catch (const GpuError&) {
      return nullptr;
    }
  }();
  return device;
}

}  // namespace foci

/// Names the device, or skips the test with a message.
#define FOCI_NEEDS_GPU(name)                            \
  const std::shared_ptr<GpuDevice> name = testDevice(); \
  if (!(name)) GTEST_SKIP() << "no OpenGL 4.5 on this machine"
