// The GPU renders the same picture of Gaussians as the CPU.
#include <gtest/gtest.h>

#include "app/evaluation/chart/chart.h"
#include "render/gl/gaussians.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lens_gaussians.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/scene.h"
#include "tests/unit/render/captured_scenes.h"
#include "tests/unit/render/gl/same_picture.h"
#include "tests/unit/render/gl/test_device.h"

namespace foci {
namespace FOCI_FILE {

class GpuGaussianPicture : public ::testing::Test {
 protected:
  /// Flat and deep Gaussians before each other, in a scene that the lens blurs on both sides.
  static GaussianCloud walls(int n = 16) {
    GaussianCloud cloud;
    addWall(cloud, 2.0f, 2.4f, n, 0.9f, {0.2f, 0.7f, 0.4f});
    addWall(cloud, 1.0f, 0.5f, n, 0.6f, {0.9f, 0.3f, 0.2f});
    addGaussian(cloud, {0.1f, 0.0f, -0.8f}, {0.02f, 0.05f, 0.2f}, 0.8f, {0.3f, 0.4f, 0.9f},
                {0.2f, 0.1f, 0.3f, std::sqrt(0.86f)});
    return cloud;
  }
  View view = squareView(64, 64.0f);
};

/// The middle of a view.
View middleOf(View view, int size_px) {
  view.principal_px -= glm::vec2((view.size_px - size_px) / 2);
  view.size_px = glm::ivec2(size_px);
  return view;
}

/// The other eye, 63 mm beside it.
View otherEye(View view) {
  view.eye_from_world[3].x -= 0.063f;
  return view;
}

/// With several layers, and with one (`kLayersFrom_JND` of gaussian_auto.cpp).
constexpr float kLayers_JND = 1.0f, kOneLayer_JND = 0.8f;

SceneInView gardenOfTheChart(int size_px) {
  for (const ChartScene& scene : planChart({.size_px = size_px}).scenes) {
    if (scene.id == "garden") return scene.make();
  }
  return {};
}

TEST_F(GpuGaussianPicture, IsTheSameOnTheChart) {
  FOCI_NEEDS_GPU(gpu);
  const SceneInView seen = gardenOfTheChart(384);
  ASSERT_TRUE(seen.scene.gaussians());
  const View middle = middleOf(seen.view, 48);
  const double px_per_m = seen.largestBlurThrough_px(1e-3) / 1e-3;
  for (const double blur_px : {0.0, 4.0, 16.0}) {
    SCOPED_TRACE(blur_px);
    RenderSettings settings = seen.settingsThrough(blur_px / px_per_m);
    settings.quality.tolerance = kOneLayer_JND;
    for (const char* method : {"pinhole", "sweep:7", "accumulate:7", "auto"}) {
      if (blur_px != 4.0 && method != std::string("auto")) continue;
      expectSamePicture(method, seen.scene, middle, settings, gpu);
    }
  }
}

// Both eyes, each at another blur, with and without depth.
TEST_F(GpuGaussianPicture, IsTheSameOfLayersOnTheChart) {
  FOCI_NEEDS_GPU(gpu);
  const SceneInView seen = gardenOfTheChart(192);
  const double px_per_m = seen.largestBlurThrough_px(1e-3) / 1e-3;
  for (const bool other : {false, true}) {
    SCOPED_TRACE(other);
    RenderSettings settings = seen.settingsThrough((other ? 8.0 : 4.0) / px_per_m);
    settings.quality.tolerance = kLayers_JND;
    settings.depth = other;
    const View eye = other ? otherEye(seen.view) : seen.view;
    expectSamePicture("sweep-lod:7", seen.scene, eye, settings, gpu);
    expectSamePicture("auto", seen.scene, middleOf(eye, 48), settings, gpu);
  }
}

class GpuCapture : public ::testing::TestWithParam<const char*> {};

TEST_P(GpuCapture, IsTheSame) {
  FOCI_NEEDS_GPU(gpu);
  if (!std::filesystem::exists(captureNamed(GetParam()))) {
    GTEST_SKIP() << "no " << captureNamed(GetParam()) << ": set FOCI_DATA";
  }
  const Captured capture(GetParam(), 256);
  const View view = middleOf(capture.view, 48);
  for (const float blur_px : {4.0f, 12.0f}) {
    SCOPED_TRACE(blur_px);
    RenderSettings settings = capture.settings(blur_px);
    settings.depth = true;
    for (const float tolerance : {kOneLayer_JND, kLayers_JND}) {
      if (blur_px == 12.0f && tolerance == kOneLayer_JND) continue;
      settings.quality.tolerance = tolerance;
      expectSamePicture("auto", capture.scene, view, settings, gpu);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Captures, GpuCapture,
                         ::testing::Values("guitar.compressed.ply", "biker.compressed.ply"),
                         [](const auto& each) {
                           return std::string(each.param, std::string_view(each.param).find('.'));
                         });

TEST_F(GpuGaussianPicture, IsTheSameThroughEveryLens) {
  FOCI_NEEDS_GPU(gpu);
  GaussianCloud cloud = walls();
  for (const bool preserves_light : {false, true}) {
    cloud.preserves_light = preserves_light;
    const GaussianCloud scene = cloud;
    RenderSettings settings = lens(12.0f, 0.8f);
    settings.lighting.background = glm::vec3(0.1f, 0.2f, 0.5f);
    settings.depth = true;
    settings.defocus.astigmatism_D = {0.3f, -0.2f};
    for (const DistanceAlong along : {DistanceAlong::axis, DistanceAlong::sight}) {
      settings.defocus.along = along;
      for (const char* method : {"sweep", "sweep:7", "sweep-lod", "inflate", "inflate:spark"}) {
        expectSamePicture(method, scene, view, settings, gpu);
      }
    }
  }
}

TEST_F(GpuGaussianPicture, IsTheSameWhereEachDirectionHasItsOwnLens) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = withTree(walls(48));
  RenderSettings settings = besideTheGaze(view, 0.8f);
  settings.depth = true;
  expectSamePicture("sweep-lod:7", scene, view, settings, gpu);
}

TEST_F(GpuGaussianPicture, IsTheSameThroughAnEyeWithAberrationsInThreeColours) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = walls();
  RenderSettings settings = lens(12.0f, 1.0f);
  settings.pupil = {.diameter_m = 6e-3, .stiles_crawford_per_mm2 = kStilesCrawford_per_mm2};
  settings.pupil.wavefront = {.zernike_um = {0, 0, 0, 0, 0, 0, -0.2, 0.4, 0, 0, 0, 0, 0.4},
                              .pupil_m = 6e-3};
  settings.pupil.diffraction_px = 0.5f;
  for (const bool in_colour : {false, true}) {
    if (in_colour) {
      settings.colours = {{-0.1f, {1, 0, 0}}, {0.0f, {0, 1, 0}}, {0.4f, {0, 0, 1}}};
    }
    for (const char* method : {"sweep:7", "sweep-lod:7", "accumulate:4"}) {
      expectSamePicture(method, scene, view, settings, gpu);
    }
  }
}

TEST_F(GpuGaussianPicture, IsTheSameOfSurfacesAndGaussiansTogether) {
  FOCI_NEEDS_GPU(gpu);
  SurfelCloud sheet;
  addSheet(sheet, 1.4f, 0.8f, 20, {0.7f, 0.7f, 0.1f}, 0.2f);
  const Scene scene = joined({walls()}, {std::move(sheet)}, "sheet");
  ASSERT_TRUE(scene.gaussians());
  ASSERT_GT(scene.size(), walls().size());
  for (const char* method : {"sweep:7", "sweep-lod:7", "auto"}) {
    expectSamePicture(method, scene, view, lens(12.0f, 0.8f), gpu);
  }
}

// A cut of merged Gaussians, with fewer samples where all is blurred.
TEST_F(GpuGaussianPicture, IsTheSameOfMergedGaussians) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = withTree(walls(96));
  RenderSettings settings = lens(30.0f, 3.0f);
  settings.depth = true;
  for (const char* method : {"sweep-lod", "sweep-lod:7"}) {
    const auto [cpu, its] =
        expectSamePicture(method, scene, squareView(160, 160.0f), settings, gpu);
    EXPECT_LT(its.splats, scene.size() / 2);
    EXPECT_NEAR(static_cast<double>(its.splats), static_cast<double>(cpu.splats),
                0.01 * static_cast<double>(cpu.splats));
  }
}

TEST_F(GpuGaussianPicture, IsTheSameAtEveryQualityLevel) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = walls();
  for (std::size_t level = 1; level <= kQualityLevels; ++level) {
    expectSamePicture("auto:" + std::to_string(level), scene, view, lens(16.0f, 0.5f), gpu);
  }
}

// The views of a tile tell its error on the GPU, too. Rounds replace parts of the first image.
TEST_F(GpuGaussianPicture, AutoPredictsTheSameError) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = walls(24);
  for (const float focus_D : {0.5f, 3.0f}) {
    for (const float tolerance : {0.1f, kLayers_JND}) {
      SCOPED_TRACE(focus_D);
      RenderSettings settings = lens(16.0f, focus_D);
      settings.depth = true;
      settings.quality.tolerance = tolerance;
      const auto [cpu, its] = expectSamePicture("auto", scene, view, settings, gpu);
      ASSERT_TRUE(cpu.tolerance_error.has_value());
      ASSERT_TRUE(its.tolerance_error.has_value());
      EXPECT_GT(*cpu.tolerance_error, 0.0);
      EXPECT_NEAR(*its.tolerance_error, *cpu.tolerance_error, 0.02 * *cpu.tolerance_error);
    }
  }
}

TEST_F(GpuGaussianPicture, HasTheSameBytesEachTime) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = walls();
  for (const char* spec : {"sweep-lod:7", "auto"}) {
    const auto method = makeMethod(spec, scene, gpu);
    Frame first, second, another;
    method->render(view, lens(12.0f, 0.5f), first);
    method->render(view, lens(3.0f, 1.0f), second);  // leaves other content in the buffers
    method->render(view, lens(12.0f, 0.5f), second);
    makeMethod(spec, scene, gpu)->render(view, lens(12.0f, 0.5f), another);
    EXPECT_EQ(first.rgba, second.rgba) << spec;
    EXPECT_EQ(first.rgba, another.rgba) << spec;
    const auto clone = method->cloneSharingScene();
    if (!clone) continue;
    clone->render(view, lens(12.0f, 0.5f), another);
    EXPECT_EQ(first.rgba, another.rgba) << spec;
  }
}

TEST_F(GpuGaussianPicture, OfLayersHasTheSameBytesEachTimeAndInLittleMemory) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud scene = withTree(walls(24));
  const View wide = squareView(256, 256.0f);
  const RenderSettings settings = lens(24.0f, 1.0f);  // in focus at the nearer wall
  LensGaussians divided(sharedWithTree(scene), gpu);
  const GaussianCutSettings lod{.per_blur2 = 0.1f, .max_px2 = 3.0f};
  divided.project(wide, settings.defocus, subApertureDiscs(61), &lod);
  EXPECT_GT(std::ranges::count_if(divided.divide(true),
                                  [](const TileLayers& tile) { return tile.count > 1; }),
            20);
  // Room for the layers of a part of the tiles. The rooms at the start fit.
  const auto narrow = GpuDevice::open(GpuDevice::Kind::any);
  narrow->limitBlocks(std::size_t{3} << 20);
  for (const char* spec : {"sweep-lod:61", "auto"}) {
    const auto method = makeMethod(spec, scene, gpu);
    Frame first, second, in_batches;
    method->render(wide, settings, first);
    method->render(otherEye(wide), settings, second);  // leaves other content in the buffers
    method->render(wide, settings, second);
    makeMethod(spec, scene, narrow)->render(wide, settings, in_batches);
    EXPECT_EQ(first.rgba, second.rgba) << spec;
    EXPECT_EQ(first.rgba, in_batches.rgba) << spec;
  }
}

TEST_F(GpuGaussianPicture, OfAnEmptySceneIsTheBackground) {
  FOCI_NEEDS_GPU(gpu);
  const GaussianCloud nothing;
  RenderSettings settings = lens(12.0f, 0.5f);
  settings.lighting.background = glm::vec3(0.25f, 0.5f, 0.75f);
  Frame frame;
  makeMethod("sweep:7", nothing, gpu)->render(view, settings, frame);
  for (const glm::vec4& pixel : frame.rgba) {
    ASSERT_LT(glm::length(pixel - glm::vec4(0.25f, 0.5f, 0.75f, 0.0f)), 1e-5f);
  }
}

TEST_F(GpuGaussianPicture, OfLargerArraysHasTheSameBytes) {
  FOCI_NEEDS_GPU(gpu);
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  GaussianCloud cloud;
  addWall(cloud, 2.0f, 8.0f, 260, 0.7f, {0.2f, 0.7f, 0.4f});  // a sixteenth of it is in view
  addWall(cloud, 1.0f, 0.5f, 40, 0.9f, {0.9f, 0.3f, 0.2f});
  cloud.degree = 3;
  for (std::size_t i = 0; i < cloud.size() * cloud.harmonicsPerGaussian(); ++i) {
    cloud.harmonics.push_back(static_cast<std::int16_t>(i * 37 % 201) - 100);
  }
  const GaussianCloud scene = withTree(std::move(cloud));
  const auto narrow = GpuDevice::open(GpuDevice::Kind::any);
  narrow->limitBlocks(3 * kMiB);  // the rooms at the start fit
  EXPECT_EQ(GpuGaussianScene(gpu, scene).windows(), 1u);
  EXPECT_EQ(GpuGaussianScene(narrow, scene).windows(), 3u);
  for (const char* method : {"sweep", "sweep-lod"}) {
    Frame whole, in_windows;
    makeMethod(method, scene, gpu)->render(view, lens(6.0f, 1.0f), whole);
    makeMethod(method, scene, narrow)->render(view, lens(6.0f, 1.0f), in_windows);
    EXPECT_EQ(whole.rgba, in_windows.rgba) << method;
  }
  expectSamePicture("sweep", scene, view, lens(6.0f, 1.0f), gpu);
}

}  // namespace FOCI_FILE
}  // namespace foci
