// Scenes that are larger than what a shader sees at once, and than what the GPU has room for.
#include <gtest/gtest.h>

#include "app/session/frame_renderer.h"
#include "render/gl/scene.h"
#include "render/lod/moment_tree.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

class GpuWindows : public ::testing::Test {
 protected:
  void SetUp() override {
    addSheet(cloud, 2.0f, 2.0f, 330, {0.2f, 0.7f, 0.4f});
    addSheet(cloud, 1.0f, 0.5f, 150, {0.9f, 0.3f, 0.2f}, 0.1f);
  }
  SurfelCloud cloud;
  View view = squareView(96, 96.0f);
};

TEST_F(GpuWindows, LargerArraysGiveTheSameBytes) {
  FOCI_NEEDS_GPU(gpu);
  const auto narrow = GpuDevice::open(GpuDevice::Kind::any);
  narrow->limitBlocks(3 * kMiB);  // the rooms at the start fit
  EXPECT_EQ(GpuScene(gpu, MomentTree(cloud)).windows(), 1u);
  const GpuScene scene(narrow, MomentTree(cloud));
  EXPECT_EQ(scene.windows(), 2u);
  EXPECT_EQ(scene.surfelWindow(0).count + scene.surfelWindow(1).count, cloud.size());
  for (const float focus_D : {1.0f, 0.5f}) {
    Frame whole, in_windows;
    makeMethod("sweep-lod:7", cloud, gpu)->render(view, lens(6.0f, focus_D), whole);
    makeMethod("sweep-lod:7", cloud, narrow)->render(view, lens(6.0f, focus_D), in_windows);
    EXPECT_EQ(whole.rgba, in_windows.rgba);
  }
}

TEST_F(GpuWindows, OneLineSaysHowMuchIsMissingAndTheCpuRenders) {
  FOCI_NEEDS_GPU(gpu);
  const auto tiny = GpuDevice::open(GpuDevice::Kind::any);
  tiny->limitBlocks(kMiB);
  RenderRequest request{.method = "sweep-lod", .size_px = {96, 96}, .eyes = {{}}};
  request.eyes[0].eye.view = view;
  request.eyes[0].settings = lens(4.0f, 0.5f);
  FrameRenderer on_cpu(cloud), on_gpu(cloud, tiny);
  RenderedFrame expected, frame;
  on_cpu.render(request, expected);
  on_gpu.render(request, frame);
  EXPECT_EQ(frame.frame.rgba, expected.frame.rgba);
  const std::string& line = on_gpu.gpuFailure();
  EXPECT_NE(line.find("need 1 MiB of its memory; it allows 1 MiB; the CPU renders"),
            std::string::npos)
      << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

}  // namespace
}  // namespace foci
