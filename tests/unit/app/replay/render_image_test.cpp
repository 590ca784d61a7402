// `foci render` goes through the frame pipeline of `foci replay`.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "app/replay/replay.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

class RenderImage : public testing::Test {
 protected:
  void SetUp() override {
    study.file = scratch.path() / "study.toml";
    std::ofstream(study.file) << "";
    study.gaze.source = scratch.path() / "gaze.tsv";
    std::ofstream gaze(study.gaze.source);
    gaze << "time_s\tx_px\ty_px\n";
    for (int i = 0; i <= 100; ++i) gaze << 0.01 * i << "\t960\t540\n";
    study.focus.accommodation.on = false;  // otherwise focus comes to rest asymptotically
    study.observer.pupil_mm = 6.0;
    study.render.method = "sweep-lod";  // `auto` takes long to check a still image
    study.output.size_px = glm::ivec2(160, 90);
    study.output.fps = 10.0;
    study.output.images = true;
  }

  /// The last frame of a replay whose observer fixates the centre of the screen, as 8-bit pixels.
  cv::Mat replayed() {
    replay(study, scratch.path() / "replay", "", 1);
    return cv::imread(scratch.path() / "replay/frame-000009.png", cv::IMREAD_COLOR);
  }

  cv::Mat rendered(std::optional<fs::path> depth = {}) {
    const fs::path file = scratch.path() / "image.png";
    renderImage(study, {.out = file, .depth = std::move(depth), .focus_D = {}, .gaze_px = {}});
    return cv::imread(file, cv::IMREAD_COLOR);
  }

  void expectEqual() {
    const cv::Mat one = replayed(), other = rendered();
    ASSERT_FALSE(one.empty());
    ASSERT_EQ(one.size(), other.size());
    EXPECT_EQ(cv::norm(one, other, cv::NORM_INF), 0.0);
  }

  TemporaryFolder scratch;
  Study study;
};

TEST_F(RenderImage, IsTheFrameOfAReplayAtTheSameEyeState) {
  study.render.method = "auto";
  study.output.size_px = glm::ivec2(64, 36);
  expectEqual();
}

TEST_F(RenderImage, TakesSplitViewAndStereo) {
  study.output.split = true;
  study.output.view = StereoView::side_by_side;
  expectEqual();
}

TEST_F(RenderImage, TakesFoveation) {
  study.render.method = "auto";
  study.quality.foveated = true;
  study.focus.fixed_D = 2.0;
  expectEqual();
  const cv::Mat foveated = rendered();
  study.quality.foveated = false;
  EXPECT_GT(cv::norm(foveated, rendered(), cv::NORM_INF), 0.0);
}

/// Gaussians of 1 mm, 5 cm apart, fill no cone by half: the eye focuses on them nevertheless.
TEST_F(RenderImage, FocusesOnSparseGaussians) {
  std::string splats;
  for (int i = 0; i < 400; ++i) {
    const float record[] = {0.05f * static_cast<float>(i % 20 - 10),
                            0.05f * static_cast<float>(i / 20 - 10),
                            0.0f,
                            1e-3f,
                            1e-3f,
                            1e-3f};
    splats.append(reinterpret_cast<const char*>(record), sizeof(record));
    splats += "\xff\xff\xff\xff\xff\x80\x80\x80";
  }
  study.scene.file = scratch.write("sparse.splat", splats);
  study.eye.position_m = {0.0, 0.0, 0.5};
  study.eye.look_at_m = {0.0, 0.0, 0.0};
  const ImageSummary summary = renderImage(
      study, {.out = scratch.path() / "image.png", .depth = {}, .focus_D = {}, .gaze_px = {}});
  ASSERT_TRUE(summary.surface_distance_m);
  EXPECT_NEAR(*summary.surface_distance_m, 0.5, 0.05);
}

TEST_F(RenderImage, HasNoFrameTimeBudget) {
  study.render.method = "auto";
  study.output.size_px = glm::ivec2(64, 36);
  const cv::Mat free = rendered();
  study.quality.frame_ms = 1.0;
  EXPECT_EQ(cv::norm(free, rendered(), cv::NORM_INF), 0.0);
}

TEST_F(RenderImage, LeavesTheLeftHalfSharp) {
  study.focus.fixed_D = 10.0;
  const cv::Mat blurred = rendered();
  study.output.split = true;
  const cv::Mat split = rendered();
  study.render.method = "pinhole";
  study.output.split = false;
  const cv::Mat sharp = rendered();
  const cv::Rect left(0, 0, 80, 90), right(81, 0, 79, 90);
  EXPECT_EQ(cv::norm(split(right), blurred(right), cv::NORM_INF), 0.0);
  // The sharp half is rendered by the study's method, which filters a little more than pinhole.
  EXPECT_LT(cv::norm(split(left), sharp(left), cv::NORM_L1),
            0.2 * cv::norm(blurred(left), sharp(left), cv::NORM_L1));
}

TEST_F(RenderImage, WritesTheDepthOfASplitView) {
  const auto depthOf = [&](const char* name) {
    rendered(scratch.path() / name);
    return textOf(scratch.path() / name);
  };
  const std::string depth = depthOf("whole.pfm");
  study.output.split = true;
  EXPECT_EQ(depthOf("split.pfm"), depth);
}

}  // namespace FOCI_FILE
}  // namespace foci
