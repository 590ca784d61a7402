// A frame that windows began must be the frame rendered at once.
#include <gtest/gtest.h>

#include <array>

#include "render/methods/lod_splats.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace {

constexpr std::array<Window, 2> kFew{Window{{96, 64}, {32, 32}}, Window{{0, 0}, {40, 8}}};
constexpr std::array<Window, 2> kMore{Window{{96, 64}, {32, 32}}, Window{{160, 128}, {32, 32}}};

/// A sheet before another one, partly in focus.
class Windows : public ::testing::Test {
 protected:
  static SurfelCloud sheets() {
    SurfelCloud cloud;
    addSheetOf(
        cloud,
        {.center_m = {0, 0, -2}, .side_m = 3.0f, .samples = 200, .color = {0.2f, 0.7f, 0.4f}});
    addSheetOf(
        cloud,
        {.center_m = {0.1f, 0, -1}, .side_m = 0.3f, .samples = 80, .color = {0.9f, 0.3f, 0.2f}});
    return cloud;
  }

  Windows() {
    settings_.background = {0.1f, 0.2f, 0.5f};
    settings_.depth = true;
  }

  Frame empty() const {
    Frame frame;
    frame.resize(view_.size_px, settings_.depth);
    return frame;
  }

  bool renderWindows(std::span<const Window> windows, const LodSettings& lod, Frame& frame) {
    return splats_.renderWindows(view_, settings_, lod, windows, frame);
  }

  /// The method that has begun the frame must end it as a new one renders it.
  void expectFrame(const LodSettings& lod, Frame& frame) {
    Frame once = empty();
    const RenderStats expected = LodSplats(cloud_).render(view_, settings_, lod, once);
    const RenderStats stats = splats_.render(view_, settings_, lod, frame);
    EXPECT_EQ(frame.rgba, once.rgba);
    EXPECT_EQ(frame.depth_m, once.depth_m);
    EXPECT_EQ(stats.splats, expected.splats);
    EXPECT_EQ(stats.fragments, expected.fragments);
  }

  SurfelCloud cloud_ = sheets();
  View view_ = squareViewOf(250, 500.0f);
  RenderSettings settings_ = blurredBy(24.0f, 0.5f);
  LodSplats splats_{cloud_};
  LodSettings whole_{.cut = kFaithfulCut}, parts_{.cut = kFaithfulCut, .sub_apertures = 7};
};

TEST_F(Windows, ThatBeganAFrameEndAsTheFrameAtOnce) {
  Frame frame = empty();
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  ASSERT_TRUE(renderWindows(kMore, parts_, frame));
  expectFrame(parts_, frame);
  expectFrame(parts_, frame);
}

TEST_F(Windows, HaveThePixelsOfTheFrame) {
  Frame once = empty(), frame = empty();
  LodSplats(cloud_).render(view_, settings_, parts_, once);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  for (const Window& window : kFew) {
    for (int y = 0; y < window.size_px.y; ++y) {
      for (int x = 0; x < window.size_px.x; ++x) {
        const glm::ivec2 at = window.corner_px + glm::ivec2(x, y);
        ASSERT_EQ(frame.at(at.x, at.y), once.at(at.x, at.y)) << at.x << ' ' << at.y;
      }
    }
  }
  EXPECT_EQ(frame.at(249, 249), glm::vec4(0.0f)) << "no window is there";
}

// Tiles through the whole aperture do not stay where sub-apertures are asked for, nor the reverse.
TEST_F(Windows, WithOtherSubAperturesAreRenderedAnew) {
  Frame frame = empty();
  ASSERT_TRUE(renderWindows(kFew, whole_, frame));
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  expectFrame(parts_, frame);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  expectFrame(whole_, frame);
}

TEST_F(Windows, OfAnotherFrameAreRenderedAnew) {
  Frame other = empty(), frame = empty();
  ASSERT_TRUE(renderWindows(kFew, parts_, other));
  expectFrame(parts_, frame);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  settings_.background = {0.9f, 0.1f, 0.1f};
  expectFrame(parts_, frame);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  settings_.defocus.focus_D += 0.5f;
  expectFrame(parts_, frame);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  view_.principal_px.x += 3.0f;
  expectFrame(parts_, frame);
  ASSERT_TRUE(renderWindows(kFew, parts_, frame));
  settings_.depth = false;
  frame = empty();
  expectFrame(parts_, frame);
}

TEST_F(Windows, AreRefusedWhereALensHasPartsOrTheCutIsTooLarge) {
  Frame frame = empty();
  settings_.pupil = {.diameter_m = 6e-3, .stiles_crawford_per_mm2 = kStilesCrawford_per_mm2};
  EXPECT_FALSE(renderWindows(kFew, parts_, frame));
  expectFrame(parts_, frame);
  settings_.pupil = {};
  view_.size_px.x = 600;
  frame = empty();
  parts_.max_splats = 100;
  EXPECT_FALSE(renderWindows(kFew, parts_, frame));
  expectFrame(parts_, frame);
}

}  // namespace
}  // namespace foci
