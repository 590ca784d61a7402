#include "render/optics/acuity.h"

#include <gtest/gtest.h>

#include "render/image/metrics.h"
#include "render/methods/lod_splats.h"
#include "render/scene/procedural.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace {

TEST(Acuity, FollowsTheFormula) {
  const Acuity acuity = acuityAround({0.0f, 0.0f}, 40.0f);
  EXPECT_EQ(acuity.finest_px(0.0f), 1.0f);  // 1/48 deg is finer than a pixel
  EXPECT_NEAR(acuity.finest_px(400.0f), 0.5f * (1.0f / 48.0f + 0.0275f * 10.0f) * 40.0f, 1e-4f);
}

// What the eye does not resolve is left out: the picture is that of many more nodes, seen through
// the same Gaussian.
TEST(Acuity, CoarseNodesLookLikeFineOnesThroughIt) {
  const SurfelCloud cloud = makeStatue();
  const View view = viewOfCamera(
      eyeFromWorld(statueEyePose().position_m, statueEyePose().target_m, statueEyePose().up),
      {256, 256}, 0.6);
  LodSplats scene(cloud);
  for (const float radius_px_per_D : {0.0f, 8.0f}) {
    const RenderSettings settings = blurredBy(radius_px_per_D, 0.5f);
    const auto drawn = [&](float per_acuity2, Frame& frame) {
      const LodSettings lod{.cut = {.per_blur2 = kFaithfulCut.per_blur2,
                                    .per_pixel2 = kFaithfulCut.per_pixel2,
                                    .per_acuity2 = per_acuity2,
                                    .acuity = {.gaze_px = {60.0f, 60.0f}, .per_px = 0.05f}},
                            .parts = 7};
      frame.resize(view.size_px);
      return scene.draw(view, settings, lod, frame).splats;
    };
    Frame coarse, fine;
    const auto few = drawn(kFaithfulCut.per_acuity2, coarse), many = drawn(0.01f, fine);
    EXPECT_LT(2 * few, many);
    EXPECT_GT(psnr_dB(coarse, fine), 48.0) << radius_px_per_D;
  }
}

}  // namespace
}  // namespace foci
