// The suite's short run: what `sweep-lod` must reach where the paper's method gives way. Bounds are
// those of docs/stability.md; what is beyond them stands there, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "app/stability_scenes.h"

namespace foci {
namespace {

constexpr StabilityEffort kShort{.views = 100};

const StabilityScene& sceneNamed(std::string_view name) {
  const auto& scenes = stabilityScenes();
  return *std::find_if(scenes.begin(), scenes.end(),
                       [&](const StabilityScene& scene) { return scene.name == name; });
}

/// Of `paper-lod` and of `sweep-lod`.
std::vector<double> scores(std::string_view name, float value) {
  return stabilityScores(sceneNamed(name), value, {"paper-lod", "sweep-lod"}, kShort);
}

TEST(EdgeShare, IsTheShareOfTheDisc) {
  EXPECT_NEAR(edgeShare(0.0, 10.0, 1.0), 0.5, 1e-12);
  EXPECT_NEAR(edgeShare(-14.1, 10.0, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(edgeShare(14.1, 10.0, 1.0), 1.0, 1e-12);
  // Half the radius in: (2 pi / 3 + sqrt(3) / 4) / pi; a narrow pixel changes that little.
  EXPECT_NEAR(edgeShare(5.0, 10.0, 0.01), 0.8045, 1e-4);
  EXPECT_NEAR(edgeShare(1.0, 0.0, 1.0), 0.8413, 1e-4);  // a standard deviation of the pixel
}

TEST(Stability, CloseParallelSurfacesStayApart) {
  const auto error = scores("parallel", 0.005f);
  EXPECT_LT(error[1], 0.02);
  EXPECT_LT(error[1], 0.25 * error[0]);
}

TEST(Stability, CrossingPlanesKeepTheirPicture) {
  const auto psnr = scores("intersecting", 45.0f);
  EXPECT_GT(psnr[1], 40.0);  // 42 is wanted and not reached: docs/stability.md
  EXPECT_GT(psnr[1], psnr[0] + 10.0);
}

TEST(Stability, IrregularSamplesCover) { EXPECT_LT(scores("density", 100.0f)[1], 0.03); }

TEST(Stability, SilhouettesFollowTheClosedForm) {
  EXPECT_LT(scores("silhouette, sharp before blurred", 8.0f)[1], 0.02);
  EXPECT_LT(scores("silhouette, blurred before sharp", 8.0f)[1], 0.02);
  EXPECT_LT(scores("close-up", 0.02f)[1], 0.02);
}

TEST(Stability, AMovingFocusDoesNotPop) { EXPECT_LT(scores("focus sweep", 20.0f)[1], 0.005); }

TEST(Stability, LightIsNeitherLostNorGained) {
  EXPECT_LT(scores("highlight", 10000.0f)[1], 0.01);
  EXPECT_LT(scores("wire", 0.2f)[1], 0.01);
  EXPECT_LT(scores("transparent", 16.0f)[1], 0.01);
}

// Whatever the dial says, every pixel of every method is a number.
TEST(Stability, ExtremesGiveNumbers) {
  for (const StabilityScene& scene : stabilityScenes()) {
    const StabilitySetup setup = scene.setup(scene.values.back());
    for (const char* method : {"paper-lod", "sweep", "sweep-lod"}) {
      const Frame frame = stabilityFrame(setup, method);
      EXPECT_TRUE(
          std::all_of(frame.rgba.begin(), frame.rgba.end(),
                      [](const glm::vec4& c) { return std::isfinite(c.r + c.g + c.b + c.a); }))
          << scene.name << ", " << method;
    }
  }
}

}  // namespace
}  // namespace foci
