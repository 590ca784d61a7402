// Scenes that are larger than what a shader sees at once, and than what the GPU has room for.
#include <gtest/gtest.h>

#include "app/session/frame_renderer.h"
#include "render/gl/image.h"
#include "render/gl/scene.h"
#include "render/lod/moment_tree.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr std::size_t kMiB = std::size_t{1} << 20;

class GpuWindows : public ::testing::Test {
 protected:
  SurfelCloud cloud;
  View view = squareView(64, 64.0f);
};

TEST_F(GpuWindows, LargerArraysGiveTheSameBytes) {
  FOCI_NEEDS_GPU(gpu);
  addSheet(cloud, 2.0f, 8.0f, 500, {0.2f, 0.7f, 0.4f});  // a sixteenth of it is in view
  addSheet(cloud, 1.0f, 0.5f, 100, {0.9f, 0.3f, 0.2f}, 0.1f);
  const auto narrow = GpuDevice::open(GpuDevice::Kind::any);
  narrow->limitBlocks(3 * kMiB);  // the rooms at the start fit
  EXPECT_EQ(GpuScene(gpu, MomentTree(cloud)).windows(), 1u);
  const GpuScene scene(narrow, MomentTree(cloud));
  EXPECT_EQ(scene.windows(), 3u);
  EXPECT_GT(scene.nodeWindow(1).count, 0u);
  EXPECT_EQ(scene.surfelWindow(2).first + scene.surfelWindow(2).count, cloud.size());
  Frame whole, in_windows;
  makeMethod("sweep-lod", cloud, gpu)->render(view, lens(6.0f, 1.0f), whole);
  makeMethod("sweep-lod", cloud, narrow)->render(view, lens(6.0f, 1.0f), in_windows);
  EXPECT_EQ(whole.rgba, in_windows.rgba);
}

TEST_F(GpuWindows, OneLineSaysHowMuchIsMissingAndTheCpuRenders) {
  FOCI_NEEDS_GPU(gpu);
  addSheet(cloud, 2.0f, 2.0f, 40, {0.2f, 0.7f, 0.4f});
  const auto tiny = GpuDevice::open(GpuDevice::Kind::any);
  tiny->limitBlocks(kMiB);
  RenderRequest request{.method = "sweep-lod", .size_px = view.size_px, .eyes = {{}}};
  request.eyes[0].eye.view = view;
  request.eyes[0].settings = lens(4.0f, 0.5f);
  const Scene scene{cloud};
  FrameRenderer on_cpu(scene), on_gpu(scene, tiny);
  RenderedFrame expected, frame;
  on_cpu.render(request, expected);
  on_gpu.render(request, frame);
  EXPECT_EQ(frame.frame.rgba, expected.frame.rgba);
  const std::string& line = on_gpu.gpuFailure();
  EXPECT_NE(line.find(" MiB of its memory; it allows 1 MiB; the CPU renders"), std::string::npos)
      << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

TEST_F(GpuWindows, OneLineNamesAnImageThatIsTooLarge) {
  FOCI_NEEDS_GPU(gpu);
  addSheet(cloud, 2.0f, 2.0f, 2, {0.2f, 0.7f, 0.4f});
  const auto tiny = GpuDevice::open(GpuDevice::Kind::any);
  tiny->limitBlocks(kMiB);
  const GpuDevice::Use use(*tiny);
  try {
    const GpuImage image(tiny, {400, 300}, false);
    FAIL() << "an image of 1.8 MiB";
  } catch (const GpuError& error) {
    EXPECT_EQ(std::string(error.what()),
              tiny->name() + ": the image's pixels need 2 MiB of its memory; it allows 1 MiB");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
