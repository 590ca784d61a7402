// Frames that stay on the GPU: what a window shows of them, what is read back, and what happens
// when the GPU fails in between.
#include <gtest/gtest.h>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "app/session/frame_renderer.h"
#include "render/image/srgb.h"
#include "tests/unit/render/gl/lost_context.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kIpd_m = 0.064, kDistance_m = 1.0;

class KeptFrame : public ::testing::Test {
 protected:
  void SetUp() override {
    addSheet(cloud, 2.0f, 2.0f, 40, {0.2f, 0.7f, 0.4f});
    addSheet(cloud, 1.0f, 0.5f, 30, {0.9f, 0.3f, 0.2f}, 0.1f);
  }

  static RenderRequest requestOf(StereoView stereo, bool split = false, bool chromatic = false) {
    RenderRequest request{
        .method = "sweep-lod", .stereo = stereo, .size_px = {16, 12}, .split = split, .eyes = {}};
    const View middle{.size_px = request.size_px,
                      .focal_px = glm::vec2(15.0f),
                      .principal_px = glm::vec2(8.0f, 6.0f)};
    RenderSettings settings = lens(6.0f, 1.0f);
    settings.lighting.background = glm::vec3(0.1f, 0.2f, 0.5f);
    if (chromatic) {
      settings.colours = {{-0.1f, {1, 0, 0}}, {0.0f, {0, 1, 0}}, {0.4f, {0, 0, 1}}};
    }
    for (const EyeView& eye : eyeViews(stereo, middle, kIpd_m, kDistance_m)) {
      request.eyes.push_back({eye, settings});
    }
    return request;
  }

  static std::vector<RenderRequest> requests() {
    return {requestOf(StereoView::mono),
            requestOf(StereoView::mono, true),
            requestOf(StereoView::mono, false, true),
            requestOf(StereoView::side_by_side),
            requestOf(StereoView::top_bottom, true),
            requestOf(StereoView::anaglyph),
            requestOf(StereoView::anaglyph, true)};
  }

  static std::vector<std::uint8_t> codesIn(GpuDevice& device, GpuTexture& texture) {
    const GpuDevice::Use use(device);
    const glm::ivec2 size_px = texture.size_px();
    std::vector<std::uint8_t> rgb(3u * static_cast<std::size_t>(size_px.x * size_px.y));
    const GLuint id = texture.beginShow();
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(id, 0, GL_RGB, GL_UNSIGNED_BYTE, static_cast<GLsizei>(rgb.size()),
                      rgb.data());
    texture.endShow();
    return rgb;
  }

  SurfelCloud cloud;
};

TEST_F(KeptFrame, TheTextureIsTheImage) {
  FOCI_NEEDS_GPU(gpu);
  const Scene scene{cloud};
  FrameRenderer renderer(scene, gpu);
  for (const RenderRequest& request : requests()) {
    for (const std::optional<double> gamma : {std::optional<double>(), std::optional(2.2)}) {
      if (gamma && request.stereo != StereoView::anaglyph) continue;
      RenderedFrame kept;
      renderer.renderKept(request, kept);
      ASSERT_TRUE(kept.on_gpu);
      const auto texture = renderer.textureOf(kept, gamma);
      ASSERT_TRUE(texture);
      EXPECT_EQ(texture->size_px(), request.size_px);
      renderer.read(kept);
      const std::vector<std::uint8_t> shown = codesIn(*gpu, *texture);
      const std::vector<std::uint8_t> expected = codesOf(kept.frame, gamma);
      ASSERT_EQ(shown.size(), expected.size());
      for (std::size_t i = 0; i < shown.size(); ++i) {
        ASSERT_NEAR(shown[i], expected[i], 1) << "byte " << i;
      }
    }
  }
}

TEST_F(KeptFrame, ReadLaterHasTheSameBytes) {
  FOCI_NEEDS_GPU(gpu);
  const Scene scene{cloud};
  FrameRenderer renderer(scene, gpu);
  for (const RenderRequest& request :
       {requestOf(StereoView::mono, false, true), requestOf(StereoView::side_by_side, true)}) {
    RenderedFrame at_once, kept;
    renderer.render(request, at_once);
    EXPECT_FALSE(at_once.on_gpu);
    renderer.renderKept(request, kept);
    RenderedFrame clone = cloneOnGpu(kept);
    renderer.startRead(clone);
    RenderRequest other = request;  // another frame follows before the first one is read
    for (auto& eye : other.eyes) eye.settings.defocus.focus_D = 0.5f;
    RenderedFrame next;
    renderer.renderKept(other, next);
    renderer.finishRead(clone);
    compose(clone);
    EXPECT_EQ(clone.frame.rgba, at_once.frame.rgba);
    renderer.read(next);
    EXPECT_NE(next.frame.rgba, at_once.frame.rgba);
  }
}

TEST_F(KeptFrame, TheCpuRendersWhatALostContextTook) {
  const LosableDevice device = losableDevice();
  if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
  const Scene scene{cloud};
  FrameRenderer on_cpu(scene), renderer(scene, device.gpu);
  RenderRequest request = requestOf(StereoView::side_by_side);
  request.method = "auto";
  RenderedFrame kept, expected;
  renderer.renderKept(request, kept);
  ASSERT_TRUE(kept.on_gpu);
  renderer.startRead(kept);
  *device.lost = true;
  renderer.finishRead(kept);
  EXPECT_NE(renderer.gpuFailure().find("its OpenGL context is lost"), std::string::npos)
      << renderer.gpuFailure();
  EXPECT_NE(renderer.gpuFailure().find("; the CPU renders"), std::string::npos);
  compose(kept);
  EXPECT_EQ(kept.request, request);
  EXPECT_EQ(kept.method, "auto");
  request.method = textOf(*kept.stats.quality_level);
  on_cpu.render(request, expected);
  EXPECT_EQ(kept.frame.rgba, expected.frame.rgba);
  renderer.render(request, kept);  // and goes on
  EXPECT_EQ(kept.frame.rgba, expected.frame.rgba);
  EXPECT_FALSE(kept.stats.gpu);
}

TEST_F(KeptFrame, TheCpuRendersWhatCannotBeShown) {
  const LosableDevice device = losableDevice();
  if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
  const Scene scene{cloud};
  FrameRenderer on_cpu(scene), renderer(scene, device.gpu);
  const RenderRequest request = requestOf(StereoView::mono);
  RenderedFrame kept, expected;
  renderer.renderKept(request, kept);
  *device.lost = true;
  EXPECT_EQ(renderer.textureOf(kept, {}), nullptr);
  EXPECT_FALSE(kept.on_gpu);
  on_cpu.render(request, expected);
  EXPECT_EQ(kept.frame.rgba, expected.frame.rgba);
}

TEST_F(KeptFrame, EveryFrameHasFullQualityWhileItsTimeAllowsIt) {
  FOCI_NEEDS_GPU(gpu);
  const Scene scene{cloud};
  FrameRenderer renderer(scene, gpu);
  RenderRequest request = requestOf(StereoView::mono);
  request.method = "auto";
  RenderedFrame frame;
  const auto renderIn = [&](float frame_ms) {
    request.eyes[0].settings.quality.frame_ms = frame_ms;
    renderer.render(request, frame);
    return frame.stats.full_quality;
  };
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(renderIn(1e6f)) << i;
  bool any = false;
  for (int i = 0; i < 3; ++i) any |= renderIn(1e-3f);
  EXPECT_FALSE(any);
}

}  // namespace FOCI_FILE
}  // namespace foci
