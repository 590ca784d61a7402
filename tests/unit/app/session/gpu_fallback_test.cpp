#include <gtest/gtest.h>

#include "app/session/frame_renderer.h"
#include "app/session/session.h"
#include "tests/unit/render/gl/lost_context.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

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
  const Scene scene{cloud};
  FrameRenderer on_cpu(scene), on_gpu(scene, gpu);
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
  const Scene scene{cloud};
  FrameRenderer on_cpu(scene), on_gpu(scene, gpu);
  RenderedFrame expected, frame;
  on_cpu.render(requestOf("paper"), expected);
  on_gpu.render(requestOf("paper"), frame);
  EXPECT_EQ(frame.frame.rgba, expected.frame.rgba);
  EXPECT_TRUE(on_gpu.gpuFailure().empty());
  EXPECT_EQ(on_gpu.deviceOf("paper"), on_cpu.deviceOf("paper"));
}

TEST(GpuFallback, ASessionNamesBothDevices) {
  const LosableDevice device = losableDevice();
  if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
  SurfelCloud cloud;
  addSheet(cloud, 2.0f, 1.0f, 20, {0.2f, 0.7f, 0.4f});
  SessionSettings settings;
  settings.method = "sweep";
  settings.device = RenderDevice::gpu;
  settings.output.size_px = {32, 18};
  const Scene scene{cloud};
  Session session(settings, scene, settings.screen, 1000.0, 0.0, device.gpu);
  const std::string cpu = FrameRenderer(scene).deviceOf("sweep"), gpu = device.gpu->text();
  EXPECT_EQ(session.devices(), gpu);  // before the first frame
  const auto render = [&](double time_s, double x_px) {
    FrameRecord record = session.lookSettled(time_s, {x_px, 100.0});
    record.pupil_mm = 4.0 + time_s;
    session.render("sweep", record);
  };
  render(0.0, 100.0);
  EXPECT_EQ(session.devices(), gpu);
  *device.lost = true;
  render(0.1, 200.0);
  EXPECT_EQ(session.devices(), gpu + ", then " + cpu);
  session.restart(0.2);
  EXPECT_EQ(session.devices(), cpu);
}

TEST(GpuFallback, APreparedBudgetAndALuminancePupilGoOnOnTheCpu) {
  SurfelCloud cloud;
  addSheet(cloud, 2.0f, 1.0f, 20, {0.2f, 0.7f, 0.4f});
  {
    const LosableDevice device = losableDevice();
    if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
    const Scene scene{cloud};
    FrameRenderer renderer(scene, device.gpu);
    RenderRequest request = requestOf("auto");
    request.eyes[0].settings.quality.frame_ms = 5.0f;
    RenderedFrame frame;
    renderer.render(request, frame);
    *device.lost = true;
    request.eyes[0].settings.defocus.focus_D = 1.0f;
    EXPECT_NO_THROW(renderer.prepare(request));
    EXPECT_NO_THROW(renderer.render(request, frame));
    EXPECT_NE(renderer.gpuFailure(), "");
  }
  const LosableDevice device = losableDevice();
  SessionSettings settings;
  settings.method = "sweep";
  settings.device = RenderDevice::gpu;
  settings.output.size_px = {32, 18};
  settings.observer.pupil = PupilModel::luminance;
  const Scene scene{cloud};
  Session session(settings, scene, settings.screen, 1000.0, 0.0, device.gpu);
  *device.lost = true;
  EXPECT_NO_THROW(session.lookSettled(0.0, {100.0, 100.0}));  // shows the pupil its first frame
  EXPECT_NE(session.deviceRemark(), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
