// The GPU renders the same picture of surfels as the CPU.
#include <gtest/gtest.h>

#include "app/evaluation/chart/chart.h"
#include "render/lod/moment_tree.h"
#include "tests/unit/render/gl/same_picture.h"
#include "tests/unit/render/gl/test_device.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

class GpuPicture : public ::testing::Test {
 protected:
  static SurfelCloud twoSheets(float opacity = 1.0f) {
    SurfelCloud cloud;
    addSheet(cloud, 2.0f, 2.0f, 60, {0.2f, 0.7f, 0.4f});
    addSheet(cloud, 1.0f, 0.5f, 40, {0.9f, 0.3f, 0.2f}, 0.1f, opacity);
    return cloud;
  }
  View view = squareView(64, 64.0f);
};

TEST_F(GpuPicture, IsTheSameOnEverySceneOfTheChart) {
  FOCI_NEEDS_GPU(gpu);
  for (const ChartScene& scene : planChart({.size_px = 384}).scenes) {
    SceneInView seen = scene.make();
    if (seen.scene.gaussians()) continue;  // gaussians_test.cpp
    const double px_per_m = seen.largestBlurThrough_px(1e-3) / 1e-3;
    // The middle of the image: the software driver is slow.
    constexpr int kPart_px = 32;
    seen.view.principal_px -= glm::vec2((seen.view.size_px - kPart_px) / 2);
    seen.view.size_px = glm::ivec2(kPart_px);
    for (const double blur_px : {0.0, 16.0}) {
      SCOPED_TRACE(scene.id + ", " + std::to_string(blur_px) + " px");
      expectSamePicture("sweep-lod:7", seen.scene, seen.view,
                        seen.settingsThrough(blur_px / px_per_m), gpu);
    }
  }
}

TEST_F(GpuPicture, IsTheSameThroughAnEyeWithAberrations) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  RenderSettings settings = lens(12.0f, 1.0f);
  settings.depth = true;
  settings.pupil = {.diameter_m = 6e-3, .stiles_crawford_per_mm2 = kStilesCrawford_per_mm2};
  settings.pupil.wavefront = {.zernike_um = {0, 0, 0, 0, 0, 0, -0.2, 0.4, 0, 0, 0, 0, 0.4},
                              .pupil_m = 6e-3};
  settings.pupil.diffraction_px = 0.5f;
  for (const char* method : {"sweep:7", "sweep-lod:7", "accumulate:4"}) {
    expectSamePicture(method, cloud, squareView(32, 32.0f), settings, gpu);
  }
}

TEST_F(GpuPicture, IsTheSameByEveryMethodThatHasIt) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  for (const MethodInfo& method : methods()) {
    if (!method.gpu) continue;
    const std::string spec = std::string(method.name) + (method.name == "accumulate" ? ":4" : "");
    for (const float focus_D : {1.0f, 0.5f}) {
      RenderSettings settings = lens(12.0f, focus_D);
      settings.lighting.background = glm::vec3(0.1f, 0.2f, 0.5f);
      settings.depth = true;
      expectSamePicture(spec, cloud, view, settings, gpu);
    }
  }
}

TEST_F(GpuPicture, IsTheSameOfMergedSurfels) {
  FOCI_NEEDS_GPU(gpu);
  SurfelCloud cloud;
  addSheet(cloud, 2.0f, 2.4f, 320, {0.2f, 0.7f, 0.4f});
  addSheet(cloud, 1.0f, 0.5f, 160, {0.9f, 0.3f, 0.2f}, 0.1f);
  cloud = withTree(std::move(cloud));
  for (const char* method : {"pinhole", "sweep", "accumulate:4"}) {
    expectSamePicture(method, cloud, squareView(48, 48.0f), lens(6.0f, 1.0f), gpu);
  }
}

TEST_F(GpuPicture, IsTheSameAtEveryQualityLevel) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  for (std::size_t level = 1; level <= kQualityLevels; ++level) {
    expectSamePicture("auto:" + std::to_string(level), cloud, view, lens(16.0f, 0.5f), gpu);
  }
}

TEST_F(GpuPicture, IsTheSameThroughGlassAndThroughAnAstigmaticEye) {
  FOCI_NEEDS_GPU(gpu);
  for (const float opacity : {1.0f, 0.4f}) {
    const SurfelCloud cloud = twoSheets(opacity);
    RenderSettings settings = lens(12.0f, 0.5f);
    settings.depth = true;
    settings.lighting.shading = 0.5f;
    expectSamePicture("sweep-lod:7", cloud, view, settings, gpu);
    settings.defocus.astigmatism_D = {0.3f, -0.2f};
    expectSamePicture("sweep-lod:7", cloud, view, settings, gpu);
    expectSamePicture("sweep", cloud, view, settings, gpu);
  }
}

TEST_F(GpuPicture, IsTheSameWhereEachDirectionHasItsOwnLens) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  RenderSettings settings = besideTheGaze(view, 0.5f);
  settings.depth = true;
  settings.lighting.shading = 0.5f;
  for (const char* method : {"sweep:7", "sweep-lod:7", "accumulate:4"}) {
    expectSamePicture(method, cloud, view, settings, gpu);
  }
}

TEST_F(GpuPicture, IsTheSameInThreeColoursAndFoveated) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  RenderSettings settings = lens(12.0f, 0.5f);
  settings.colours = {{-0.1f, {1, 0, 0}}, {0.0f, {0, 1, 0}}, {0.4f, {0, 0, 1}}};
  settings.quality.acuity = acuityAround({14.0f, 20.0f}, 2.0f);
  expectSamePicture("auto", cloud, view, settings, gpu);
}

TEST_F(GpuPicture, HasTheSameBytesEachTime) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud cloud = twoSheets();
  const auto method = makeMethod("sweep-lod:7", cloud, gpu);
  Frame first, second, clone;
  method->render(view, lens(12.0f, 0.5f), first);
  method->render(view, lens(3.0f, 1.0f), second);  // leaves other content in the buffers
  method->render(view, lens(12.0f, 0.5f), second);
  makeMethod("sweep-lod:7", cloud, gpu)->render(view, lens(12.0f, 0.5f), clone);
  EXPECT_EQ(first.rgba, second.rgba);
  EXPECT_EQ(first.rgba, clone.rgba);
}

TEST_F(GpuPicture, OfAnEmptySceneIsTheBackground) {
  FOCI_NEEDS_GPU(gpu);
  const SurfelCloud nothing;
  RenderSettings settings = lens(12.0f, 0.5f);
  settings.lighting.background = glm::vec3(0.25f, 0.5f, 0.75f);
  for (const char* method : {"sweep", "sweep-lod", "auto"}) {
    Frame frame;
    makeMethod(method, nothing, gpu)->render(view, settings, frame);
    for (const glm::vec4& pixel : frame.rgba) {
      ASSERT_LT(glm::length(pixel - glm::vec4(0.25f, 0.5f, 0.75f, 0.0f)), 1e-6f) << method;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
