// A frame of many splats is rendered strip by strip: it must be the frame at once.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "render/image/metrics.h"
#include "render/methods/lod_splats.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

/// A sheet before another one, across three strips and a part of a fourth.
class Strips : public ::testing::Test {
 protected:
  Strips() {
    addSheetOf(
        cloud_,
        {.center_m = {0, 0, -2}, .side_m = 3.0f, .samples = 200, .color = {0.2f, 0.7f, 0.4f}});
    addSheetOf(
        cloud_,
        {.center_m = {0.1f, 0, -1}, .side_m = 0.5f, .samples = 80, .color = {0.9f, 0.3f, 0.2f}});
    view_.size_px = {820, 60};
    view_.principal_px = {410.0f, 30.0f};
  }

  Frame frameOf(const RenderSettings& settings, LodSettings lod, std::size_t max_splats) {
    lod.max_splats = max_splats;
    Frame frame;
    frame.resize(view_.size_px, settings.depth);
    splats_ = LodSplats(cloud_).render(view_, settings, lod, frame).splats;
    return frame;
  }

  /// Blur, sub-apertures, depth, and detail that falls off from the gaze.
  static RenderSettings seenByAnEye() {
    RenderSettings settings = blurredBy(12.0f, 0.5f);
    settings.lighting.background = {0.1f, 0.2f, 0.5f};
    settings.depth = true;
    return settings;
  }
  static LodSettings foveated() {
    LodSettings lod{.cut = kFaithfulCut, .sub_apertures = 7};
    lod.cut.acuity = {.gaze_px = {300.0f, 20.0f}, .base_px = 1.0f, .per_px = 0.01f};
    return lod;
  }

  SurfelCloud cloud_;
  View view_ = squareViewOf(60, 500.0f);
  std::uint64_t splats_ = 0;
};

TEST_F(Strips, AreTheFrameAtOnce) {
  for (const bool eye : {false, true}) {
    const RenderSettings settings = eye ? seenByAnEye() : RenderSettings{};
    const LodSettings lod = eye ? foveated() : LodSettings{.cut = kFaithfulCut};
    const Frame once = frameOf(settings, lod, 1u << 30);
    const std::uint64_t splats = splats_;
    const Frame strips = frameOf(settings, lod, 100);
    EXPECT_GT(splats_, splats) << "a splat across two strips counts in both";
    EXPECT_GE(psnr_dB(once, strips), 70.0);
    ASSERT_EQ(once.depth_m.size(), strips.depth_m.size());
    for (std::size_t p = 0; p < once.depth_m.size(); ++p) {
      if (once.rgba[p].a < 0.1f) continue;
      ASSERT_NEAR(once.depth_m[p], strips.depth_m[p], 1e-3f) << p;
    }
  }
}

TEST_F(Strips, SameBytesAtAnyNumberOfThreads) {
  const Frame many = frameOf(seenByAnEye(), foveated(), 100);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Frame alone = frameOf(seenByAnEye(), foveated(), 100);
  EXPECT_EQ(many.rgba, alone.rgba);
  EXPECT_EQ(many.depth_m, alone.depth_m);
}

}  // namespace FOCI_FILE
}  // namespace foci
