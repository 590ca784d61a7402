#include "render/optics/acuity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/quantile.h"
#include "render/image/metrics.h"
#include "render/methods/lod_splats.h"
#include "render/methods/quality_level_table.h"
#include "render/scene/builtin/procedural.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

TEST(Acuity, FollowsTheFormula) {
  const Acuity acuity = acuityAround({0.0f, 0.0f}, 40.0f);
  EXPECT_EQ(acuity.finest_px(0.0f), 1.0f);  // 1/48 deg is finer than a pixel
  EXPECT_NEAR(acuity.finest_px(400.0f), 0.5f * (1.0f / 48.0f + 0.0275f * 10.0f) * 40.0f, 1e-4f);
}

View viewOfStatue() {
  const auto pose = statueEyePose();
  return viewOfCamera(eyeFromWorld(pose.position_m, pose.target_m, pose.up), {256, 256}, 0.6);
}

// Coarse nodes leave out only what the eye does not resolve: through the same Gaussian their image
// equals that of many more nodes.
TEST(Acuity, CoarseNodesLookLikeFineOnesThroughIt) {
  const SurfelCloud cloud = makeStatue();
  const View view = viewOfStatue();
  LodSplats scene(cloud);
  for (const float radius_px_per_D : {0.0f, 8.0f}) {
    const RenderSettings settings = blurredBy(radius_px_per_D, 0.5f);
    const auto rendered = [&](float per_acuity2, Frame& frame) {
      const LodSettings lod{.cut = {.per_blur2 = kFaithfulCut.per_blur2,
                                    .per_pixel2 = kFaithfulCut.per_pixel2,
                                    .per_acuity2 = per_acuity2,
                                    .acuity = {.gaze_px = {60.0f, 60.0f}, .per_px = 0.05f}},
                            .sub_apertures = 7};
      frame.resize(view.size_px);
      return scene.render(view, settings, lod, frame).splats;
    };
    Frame coarse, fine;
    const auto few = rendered(kFaithfulCut.per_acuity2, coarse), many = rendered(0.01f, fine);
    EXPECT_LT(2 * few, many);
    EXPECT_GT(psnr_dB(coarse, fine), 48.0) << radius_px_per_D;
  }
}

Frame through(double sigma_px, const Frame& frame) {
  Frame blurred = frame;
  cv::Mat to(frame.size_px.y, frame.size_px.x, CV_32FC4, blurred.rgba.data());
  cv::GaussianBlur(to, to, {}, sigma_px, 0.0, cv::BORDER_REPLICATE);
  return blurred;
}

// For an eye of that acuity the image of coarse nodes, at few samples, equals the full image.
TEST(Acuity, WhatIsLeftOutIsNotSeen) {
  const SurfelCloud cloud = makeStatue();
  const View view = viewOfStatue();
  const RenderSettings settings = blurredBy(4.0f, 0.5f);
  LodSettings lod = settingsOf(QualityLevel::whole_aperture).lod;
  LodSplats scene(cloud);
  Frame full, rendered;
  full.resize(view.size_px);
  rendered.resize(view.size_px);
  const auto all = scene.render(view, settings, lod, full);
  for (const float sigma_px : {1.5f, 3.0f, 6.0f}) {
    lod.cut.acuity.base_px = sigma_px;
    const auto few = scene.render(view, settings, lod, rendered);
    EXPECT_LT(few.splats, all.splats);
    EXPECT_LT(few.fragments, all.fragments);
    // The prefilter of either image is one pixel of the Gaussian.
    const double wider_px = std::sqrt(sigma_px * sigma_px - 1.0f);
    const Frame seen_of_full = through(sigma_px, through(wider_px, full));
    auto apart = visibleDifference(seen_of_full, through(sigma_px, rendered), kUsualPx_per_deg);
    EXPECT_LT(quantile(apart, 0.95), 1.0) << sigma_px;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
