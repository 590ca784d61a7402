#include "render/methods/spot_check.h"

#include <gtest/gtest.h>

#include "render/scene/builtin/procedural.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr LodSettings kBest{.cut = kFaithfulCut, .sub_apertures = 7};
constexpr LodSettings kCoarse{.cut = {.per_blur2 = 0.2f, .per_pixel2 = 0.6f}};
constexpr LodSettings kPinhole{.cut = kPixelCut, .sharp = true};

class SpotCheckTest : public ::testing::Test {
 protected:
  SpotCheckTest() {
    addSheetOf(cloud, {.center_m = {0.1f, 0.2f, 0.1f},
                       .right = {0.6f, 0.0f, -0.8f},
                       .up = {0.0f, 1.0f, 0.0f},
                       .side_m = 0.3f,
                       .samples = 60,
                       .color = {0.8f, 0.1f, 0.1f}});
  }

  SurfelCloud cloud = makePlane(160, 1.0f);
  View view = [] {
    View tilted = squareViewOf(320, 480.0f);
    tilted.eye_from_world =
        eyeFromWorld({0.0f, 0.9f, 0.9f}, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f});
    return tilted;
  }();
  float blur_px = 10.0f;  // bounds that of the plane

  SpotCheck checkOf(const RenderSettings& settings, const Acuity& acuity = {}) const {
    std::vector<LodSettings> levels{kCoarse, kBest, kPinhole};
    for (LodSettings& level : levels) level.cut.acuity = acuity;
    const bool blurred = settings.defocus.radius_px_per_D.x > 0.0f;
    return {treeOf(cloud), view, settings, blurred ? blur_px : 0.0f, std::move(levels)};
  }
};

TEST_F(SpotCheckTest, MeasuresTheErrorAgainstManyViews) {
  const RenderSettings settings = blurredBy(20.0f, 1.0f / 1.27f);
  SpotCheck check = checkOf(settings);
  EXPECT_FALSE(check.error(0));
  int steps = 0;
  while (!check.isDone()) {
    check.step();
    EXPECT_LT(++steps, 1000);
  }
  EXPECT_GT(steps, 3);
  const Frame truth = renderedBy("accumulate:256", cloud, view, settings);
  LodSplats scene(cloud);
  for (const std::size_t level : {0u, 2u}) {
    Frame frame;
    frame.resize(view.size_px);
    scene.render(view, settings, level == 0 ? kCoarse : kPinhole, frame);
    const float expected = visibleErrorOf(frame, truth);
    EXPECT_GT(expected, 0.3f) << level;
    EXPECT_NEAR(*check.error(level), expected, 0.25f * expected) << level;
  }
  EXPECT_LT(*check.error(1), *check.error(0));
  EXPECT_LT(*check.errorOfTruth(), 0.5f);
}

// No surfel that a square shows is left out of its views: without blur they are the frame.
TEST_F(SpotCheckTest, ASharpFrameIsItsOwnTruth) {
  SpotCheck check = checkOf(blurredBy(0.0f, 0.0f));
  while (!check.isDone()) check.step();
  EXPECT_LT(*check.error(2), 0.01f);
  EXPECT_LT(*check.errorOfTruth(), 1e-4f);  // rounding of the parts' shares
}

// Nor is one of a wall beside a wide view, which depth spreads over the image.
TEST_F(SpotCheckTest, ASharpWideFrameIsItsOwnTruth) {
  view = squareViewOf(320, 320.0f);
  view.principal_px.x = -400.0f;  // the right end of a view of 140 deg
  cloud = {};
  for (const float side : {-1.0f, 1.0f}) {
    addSheetOf(cloud, {.center_m = {3.0f * side, 0.0f, -2.5f},
                       .right = {0.0f, 0.0f, side},
                       .side_m = 4.0f,
                       .samples = 50});
  }
  for (std::size_t i = 0; i < cloud.size(); i += 3) cloud.color[i] = glm::vec3(0.0f);
  SpotCheck check = checkOf(blurredBy(0.0f, 0.0f));
  while (!check.isDone()) check.step();
  EXPECT_LT(*check.error(2), 0.01f);
}

// Nor is one left out that shows by the wide prefilter away from the gaze, and squares share the
// gaze of the frame.
TEST_F(SpotCheckTest, ASharpFrameOfAnEyeIsItsOwnTruth) {
  SpotCheck check = checkOf(blurredBy(0.0f, 0.0f),
                            {.gaze_px = {300.0f, 40.0f}, .base_px = 0.5f, .per_px = 0.04f});
  while (!check.isDone()) check.step();
  EXPECT_LT(*check.error(2), 0.15f);  // of tiles with fewer samples
}

// Away from the gaze, errors count as far as the eye sees them.
TEST_F(SpotCheckTest, AnEyeSeesSmallerErrorsAwayFromTheGaze) {
  SpotCheck seen = checkOf(blurredBy(20.0f, 1.0f / 1.27f),
                           {.gaze_px = {300.0f, 40.0f}, .base_px = 0.5f, .per_px = 0.04f}),
            everywhere = checkOf(blurredBy(20.0f, 1.0f / 1.27f));
  while (!seen.isDone()) seen.step();
  while (!everywhere.isDone()) everywhere.step();
  for (const std::size_t level : {0u, 2u}) {
    EXPECT_LT(*seen.error(level), 0.7f * *everywhere.error(level)) << level;
  }
  const auto eye_px = static_cast<float>(kUsualPx_per_deg * kEye_deg);
  SpotCheck sharp = checkOf(blurredBy(20.0f, 1.0f / 1.27f), {.base_px = eye_px, .per_px = 1e-9f});
  while (!sharp.isDone()) sharp.step();
  EXPECT_NEAR(*sharp.error(0), *everywhere.error(0), 1e-3f) << "at the gaze";
}

}  // namespace FOCI_FILE
}  // namespace foci
