#include <gtest/gtest.h>

#include "app/session/frame_renderer.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace {

RenderRequest requestOf(const std::string& method) {
  RenderRequest request{.method = method, .size_px = {32, 32}, .eyes = {{}}};
  request.eyes[0].eye.view = squareView(32, 32.0f);
  request.eyes[0].settings = lens(4.0f, 0.5f);
  return request;
}

TEST(GpuFallback, TheCpuGoesOnWhereTheGpuFails) {
  FOCI_NEEDS_GPU(gpu);
  if (!gpu->isSoftware()) GTEST_SKIP() << "this GPU renders what the software driver cannot";
  SurfelCloud cloud;  // more splats in a tile than the software driver sorts
  addSheet(cloud, 2.0f, 1.0f, 330, {0.2f, 0.7f, 0.4f});
  FrameRenderer on_cpu(cloud), on_gpu(cloud, gpu);
  EXPECT_EQ(on_gpu.deviceOf("sweep"), gpu->text());
  RenderedFrame expected, frame;
  on_cpu.render(requestOf("sweep"), expected);
  on_gpu.render(requestOf("sweep"), frame);
  EXPECT_EQ(frame.frame.rgba, expected.frame.rgba);
  EXPECT_NE(on_gpu.gpuFailure().find("; the CPU renders"), std::string::npos)
      << on_gpu.gpuFailure();
  EXPECT_EQ(on_gpu.deviceOf("sweep"), on_cpu.deviceOf("sweep"));
}

TEST(GpuFallback, AMethodWithoutCodeForTheGpuRendersOnTheCpu) {
  FOCI_NEEDS_GPU(gpu);
  SurfelCloud cloud;
  addSheet(cloud, 2.0f, 1.0f, 20, {0.2f, 0.7f, 0.4f});
  FrameRenderer on_cpu(cloud), on_gpu(cloud, gpu);
  RenderedFrame expected, frame;
  on_cpu.render(requestOf("paper"), expected);
  on_gpu.render(requestOf("paper"), frame);
  EXPECT_EQ(frame.frame.rgba, expected.frame.rgba);
  EXPECT_TRUE(on_gpu.gpuFailure().empty());
  EXPECT_EQ(on_gpu.deviceOf("paper"), on_cpu.deviceOf("paper"));
}

}  // namespace
}  // namespace foci
