// Captured scenes through the lens, against the average of pinholes. The captures are not part of
// the project: the tests skip where they are absent.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/scene/io/gaussian_formats.h"
#include "tests/unit/render/captured_scenes.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr int kSize_px = 256;

class GaussianCaptures : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(captureNamed(GetParam()))) {
      GTEST_SKIP() << "no " << captureNamed(GetParam()) << ": set FOCI_DATA";
    }
  }
};

TEST_P(GaussianCaptures, SevenSubAperturesAreCloseToALens) {
  constexpr double kGoal_dB = 45.0;
  const Captured capture(GetParam(), 384);
  for (const float blur_px : {4.0f, 10.0f, 20.0f}) {
    const RenderSettings settings = capture.settings(blur_px);
    const Frame lens = render("accumulate:64", capture.scene, capture.view, settings);
    const Frame parts = render("sweep:7", capture.scene, capture.view, settings);
    EXPECT_GT(psnr_dB(parts, lens), kGoal_dB) << blur_px;
  }
}

TEST_P(GaussianCaptures, SubAperturesAreCloserToALensThanInflatedGaussians) {
  const Captured capture(GetParam(), kSize_px);
  const RenderSettings settings = capture.settings(10.0f);
  const Frame lens = render("accumulate:64", capture.scene, capture.view, settings);
  double last_dB = psnr_dB(render("sweep:7", capture.scene, capture.view, settings), lens);
  for (const char* method : {"sweep", "inflate", "inflate:spark", "inflate:splat-transform"}) {
    const double inflated_dB = psnr_dB(render(method, capture.scene, capture.view, settings), lens);
    EXPECT_LT(inflated_dB, last_dB) << method;
    last_dB = inflated_dB;
  }
}

TEST_P(GaussianCaptures, LevelsOfDetailLeaveTheQualityOfSevenSubApertures) {
  constexpr double kLoss_dB = 1.0;
  const Captured capture(GetParam(), 384);
  for (const float blur_px : {10.0f, 20.0f}) {
    const RenderSettings settings = capture.settings(blur_px);
    const Frame lens = render("accumulate:64", capture.scene, capture.view, settings);
    const double all_dB = psnr_dB(render("sweep:7", capture.scene, capture.view, settings), lens);
    Frame merged;
    const RenderStats stats =
        makeMethod("sweep-lod:7", capture.scene)->render(capture.view, settings, merged);
    // At 10 px both are far above what shows.
    constexpr double kEnough_dB = 48.0;
    EXPECT_GT(psnr_dB(merged, lens), std::min(all_dB - kLoss_dB, kEnough_dB));
    EXPECT_LT(stats.splats, capture.scene.size() * 3 / 4);
  }
}

TEST_P(GaussianCaptures, BlurEverywhereTakesLittle) {
  const Captured capture(GetParam(), 384);
  const RenderSettings settings = blurredEverywhere(capture, 20.0f);
  const Frame lens = render("accumulate:64", capture.scene, capture.view, settings);
  Frame all, merged;
  const RenderStats of_all =
      makeMethod("sweep:7", capture.scene)->render(capture.view, settings, all);
  const RenderStats of_merged =
      makeMethod("sweep-lod:7", capture.scene)->render(capture.view, settings, merged);
  EXPECT_LT(of_merged.splats, of_all.splats / 2);
  EXPECT_LT(of_merged.fragments, of_all.fragments / 20);
  EXPECT_GT(psnr_dB(merged, lens), psnr_dB(all, lens) - 1.0);
}

TEST_P(GaussianCaptures, AutoKeepsItsPrediction) {
  const Captured capture(GetParam(), 384);
  for (const auto& [blur_px, settings] :
       {std::pair(4.0f, capture.settings(4.0f)), std::pair(12.0f, capture.settings(12.0f)),
        std::pair(10.0f, blurredEverywhere(capture, 10.0f))}) {
    const Frame lens = render("accumulate:64", capture.scene, capture.view, settings);
    Frame frame;
    const RenderStats stats =
        makeMethod("auto", capture.scene)->render(capture.view, settings, frame);
    std::vector<float> error = visibleDifference(frame, lens, kUsualPx_per_deg);
    std::ranges::sort(error);
    EXPECT_LE(error[error.size() * 95 / 100], *stats.tolerance_error) << blur_px;
    EXPECT_LE(*stats.tolerance_error, settings.quality.tolerance) << blur_px;
  }
}

// The promise for the frame leaves most of a small object to the choice of its tiles.
TEST_P(GaussianCaptures, AutoRendersASmallObjectWithLessWorkThanNineteenSubApertures) {
  Captured capture(GetParam(), 360);
  capture.view.principal_px.x += 140.0f;
  capture.view.size_px.x = 640;
  const RenderSettings settings = capture.settings(20.0f);
  Frame frame;
  const RenderStats tested =
      makeMethod("auto", capture.scene)->render(capture.view, settings, frame);
  const RenderStats whole =
      makeMethod("sweep-lod:19", capture.scene)->render(capture.view, settings, frame);
  EXPECT_LT(tested.fragments, whole.fragments);
  EXPECT_LE(*tested.tolerance_error, settings.quality.tolerance);
}

// The eye moves sideways by 0.5 mm a frame. 99.9 % of the pixels change by less than this beyond
// the change of the mean of pinholes, in linear light: the goal for `auto`.
TEST_P(GaussianCaptures, PopsLittleWhileTheEyeMoves) {
  constexpr double kGoal = 0.01;
  constexpr float kStep_m = 5e-4f;
  constexpr int kFrames = 12;
  const Captured capture(GetParam(), kSize_px);
  const RenderSettings settings = capture.settings(10.0f);
  const auto tested = makeMethod("auto", capture.scene);
  const auto lens = makeMethod("accumulate:32", capture.scene);
  View view = capture.view;
  Frame frame, before, exact, exact_before;
  for (int k = 0; k < kFrames; ++k) {
    tested->render(view, settings, frame);
    lens->render(view, settings, exact);
    std::vector<float> extra;
    for (std::size_t i = 0; k > 0 && i < frame.rgba.size(); ++i) {
      const glm::vec3 change = glm::abs(glm::vec3(frame.rgba[i] - before.rgba[i]));
      const glm::vec3 beyond = change - glm::abs(glm::vec3(exact.rgba[i] - exact_before.rgba[i]));
      extra.push_back(std::max({beyond.r, beyond.g, beyond.b, 0.0f}));
    }
    std::ranges::sort(extra);
    if (k > 0) {
      EXPECT_LE(extra[extra.size() * 999 / 1000], kGoal) << k;
    }
    before = frame;
    exact_before = exact;
    view.eye_from_world[3].x -= kStep_m;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, GaussianCaptures,
                         testing::Values("guitar.compressed.ply", "biker.compressed.ply"),
                         [](const auto& test) { return std::string(test.param).substr(0, 5); });

TEST(GaussianCapture, TheSameSceneInTwoFormatsLooksTheSame) {
  if (!std::filesystem::exists(captureNamed("biker.spz"))) {
    GTEST_SKIP() << "no " << captureNamed("biker.spz") << ": set FOCI_DATA";
  }
  constexpr double kGoal_dB = 40.0;
  const Captured ply("biker.compressed.ply", kSize_px), spz("biker.spz", kSize_px);
  EXPECT_EQ(ply.scene.size(), spz.scene.size());
  View view = ply.view;
  // SPZ is turned by half a turn about x.
  glm::mat4 turn(1.0f);
  turn[1][1] = turn[2][2] = -1.0f;
  view.eye_from_world = ply.view.eye_from_world * turn;
  const Frame a = render("pinhole", ply.scene, ply.view, {});
  const Frame b = render("pinhole", spz.scene, view, {});
  EXPECT_GT(psnr_dB(a, b), kGoal_dB);
}

}  // namespace FOCI_FILE
}  // namespace foci
