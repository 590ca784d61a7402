#include "render/methods/spot_check.h"

#include <gtest/gtest.h>

#include "base/quantile.h"
#include "render/image/visible_difference.h"
#include "render/scene/builtin/procedural.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace {

constexpr LodSettings kBest{.cut = kFaithfulCut, .sub_apertures = 7};
constexpr LodSettings kCoarse{.cut = {.per_blur2 = 0.06f, .per_pixel2 = 0.3f}};

class SpotCheckTest : public ::testing::Test {
 protected:
  SurfelCloud cloud = makePlane(160, 1.0f);
  LodSplats scene{cloud};
  RenderSettings settings = blurredBy(40.0f, 1.0f / 1.27f);

  static View tilted(int size_px) {
    View view = squareViewOf(size_px, 1.5f * static_cast<float>(size_px));
    view.eye_from_world = eyeFromWorld({0.0f, 0.9f, 0.9f}, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f});
    return view;
  }

  float errorOf(const View& view, const LodSettings& lod, float limit) {
    Frame frame;
    frame.resize(view.size_px);
    return SpotCheck(scene, view, settings, kBest, frame).error(lod, limit);
  }

  Frame rendered(const View& view, const LodSettings& lod) {
    Frame frame;
    frame.resize(view.size_px);
    scene.render(view, settings, lod, frame);
    return frame;
  }
};

constexpr float kLimit = 1.0f;

TEST_F(SpotCheckTest, OfASmallViewComparesTheFullFrames) {
  for (const int size_px : {20, 128}) {
    const View view = tilted(size_px);
    auto apart =
        visibleDifference(rendered(view, kCoarse), rendered(view, kBest), kUsualPx_per_deg);
    EXPECT_EQ(errorOf(view, kCoarse, kLimit), quantile(apart, 0.95)) << size_px;
    EXPECT_EQ(errorOf(view, kBest, kLimit), 0.0f);
  }
}

// A few squares estimate the error of a larger image. Fewer squares suffice where the error is far
// from the limit.
TEST_F(SpotCheckTest, EstimatesTheErrorFromSomeSquares) {
  const View view = tilted(416);
  auto apart = visibleDifference(rendered(view, kCoarse), rendered(view, kBest), kUsualPx_per_deg);
  const float expected = quantile(apart, 0.95);
  EXPECT_GT(expected, 0.2f);
  for (const float limit : {0.1f * expected, expected}) {
    EXPECT_NEAR(errorOf(view, kCoarse, limit), expected, 0.2f * expected) << limit;
  }
  const float at_most = errorOf(view, kCoarse, 10.0f * expected);
  EXPECT_GE(at_most, expected);
  EXPECT_LE(at_most, 2.4f * expected);
}

}  // namespace
}  // namespace foci
