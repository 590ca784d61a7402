// A short run of the stability suite: the scores that `sweep-lod` must reach where the paper's
// method fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "app/evaluation/stability/measure.h"
#include "app/evaluation/stability/scenes.h"
#include "app/evaluation/stability/setups.h"

namespace foci {
namespace {

using stability::discThroughGaussian;
using stability::edgeShare;

constexpr StabilityEffort kShort{.samples = 48, .steps = 4};

const StabilityScene& sceneNamed(std::string_view name) {
  const auto& scenes = stabilityScenes();
  return *std::find_if(scenes.begin(), scenes.end(),
                       [&](const StabilityScene& scene) { return scene.name == name; });
}

/// The scores of `paper-lod` and of `sweep-lod`.
std::vector<double> scores(std::string_view name, float value) {
  StabilityTrial trial(sceneNamed(name), value, kShort);
  return {trial.score("paper-lod"), trial.score("sweep-lod")};
}

double observed(std::string_view name, std::size_t observer, float value) {
  return sceneNamed(name).observe(observer, value);
}

TEST(EdgeShare, IsTheShareOfTheDisc) {
  EXPECT_NEAR(edgeShare(0.0, 10.0, 1.0), 0.5, 1e-12);
  EXPECT_NEAR(edgeShare(-14.1, 10.0, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(edgeShare(14.1, 10.0, 1.0), 1.0, 1e-12);
  // Half the radius in: (2 pi / 3 + sqrt(3) / 4) / pi; a narrow pixel changes that little.
  EXPECT_NEAR(edgeShare(5.0, 10.0, 0.01), 0.8045, 1e-4);
  EXPECT_NEAR(edgeShare(1.0, 0.0, 1.0), 0.8413, 1e-4);  // a standard deviation of the pixel
}

TEST(DiscThroughGaussian, HasUnitLightAndIsFlatInAWideDisc) {
  constexpr double kPi = 3.14159265358979;
  double volume = 0.0;
  for (double r = 0.05; r < 20.0; r += 0.1) {
    volume += 2.0 * kPi * r * 0.1 * discThroughGaussian(r, 10.0, 1.2);
  }
  EXPECT_NEAR(volume, 1.0, 1e-3);
  EXPECT_NEAR(discThroughGaussian(0.0, 10.0, 1.2), 1.0 / (kPi * 100.0), 1e-6);
  EXPECT_NEAR(discThroughGaussian(10.0, 10.0, 1.2) * kPi * 100.0, 0.5, 0.05);  // half in its edge
}

// Rays through the lens agree with the closed form, which does without rays.
TEST(ExactFrame, FollowsTheClosedFormAtAnOutline) {
  for (const float radius_px : {1.0f, 8.0f}) {
    for (const char* name : {"sharp-before-blurred", "blurred-before-sharp"}) {
      StabilityTrial trial(sceneNamed(name), radius_px, {.samples = 100});
      EXPECT_LT(trial.setup().score(trial.reference()), 0.004) << name << " " << radius_px;
    }
  }
}

// Splats and rays agree on a sheet in focus that nothing hides.
TEST(ExactFrame, AgreesWithSplatsOnASheetInFocus) {
  StabilityTrial trial(sceneNamed("slanted"), 0.0f, {.samples = 200});
  EXPECT_GT(trial.score("sweep"), 50.0);
}

// Without blur, each side of the line where two sheets cross shows the nearer sheet alone.
TEST(ExactFrame, TellsCrossingSheetsApart) {
  using namespace stability;
  const float a = 0.5f;
  const std::vector<Sheet> sheets = {
      {.centre_m = {0, 0, -1}, .size_m = glm::vec2(1.2f), .color = plain({1, 0, 0})},
      {.centre_m = {0, 0, -1},
       .size_m = glm::vec2(1.2f),
       .across = {std::cos(a), 0, std::sin(a)},
       .color = plain({0, 1, 0})}};
  const Frame frame = exactFrame(sheets, view(), lens(0.0f, 1.0f), 4);
  EXPECT_NEAR(frame.at(20, 64).r, 1.0f, 1e-5f);  // left of the line the slanted sheet is behind
  EXPECT_NEAR(frame.at(108, 64).g, 1.0f, 1e-5f);
  EXPECT_NEAR(frame.at(63, 64).r, 0.69f, 0.02f);  // half a pixel left of the line
}

TEST(Stability, CloseParallelSurfacesStayApart) {
  const auto error = scores("parallel", 0.005f);
  EXPECT_LT(error[1], 0.02);
  EXPECT_LT(error[1], 0.25 * error[0]);
  EXPECT_LT(scores("parallel", 0.002f)[1], 0.02);  // the gap is one sample wide
}

// At any angle, each ray sees the nearer plane, although the two are one layer where they meet.
TEST(Stability, CrossingPlanesKeepTheirImage) {
  for (const float angle_deg : {5.0f, 45.0f, 85.0f}) {
    const auto psnr = scores("crossing", angle_deg);
    EXPECT_GT(psnr[1], 42.0) << angle_deg;
    EXPECT_GT(psnr[1], psnr[0] + 10.0) << angle_deg;
    // `auto` renders a whole-aperture pass first and goes on to sub-apertures if it needs them.
    StabilityTrial trial(sceneNamed("crossing"), angle_deg, kShort);
    EXPECT_GT(trial.score("auto"), 42.0) << angle_deg;
  }
}

// Where layers cross, the light that one transmits falls on the next.
TEST(Stability, CrossingLayersLetLightThrough) {
  for (const float layers : {2.0f, 6.0f}) EXPECT_GT(scores("crossing-layers", layers)[1], 42.0);
}

// One side of the lens sees more of a slanted plane than the other.
TEST(Stability, SlantedPlanesKeepTheirImage) {
  EXPECT_GT(scores("slanted", 60.0f)[1], 48.0);
  EXPECT_GT(scores("slanted", 75.0f)[1], 38.0);
  // Here it sees both sides; `auto` measures its error.
  StabilityTrial edge_on(sceneNamed("slanted"), 85.0f, kShort);
  EXPECT_GT(edge_on.score("auto"), 35.0);
}

TEST(Stability, IrregularSamplesCover) {
  EXPECT_LT(scores("density", 100.0f)[1], 0.03);
  EXPECT_LT(scores("normals", 10.0f)[1], 0.02);
  // Copies of a point change nothing, even if all inspected neighbours are copies.
  EXPECT_NEAR(scores("duplicates", 16.0f)[1], scores("duplicates", 1.0f)[1], 0.002);
}

TEST(Stability, SilhouettesFollowTheClosedForm) {
  EXPECT_LT(scores("sharp-before-blurred", 8.0f)[1], 0.02);
  EXPECT_LT(scores("blurred-before-sharp", 8.0f)[1], 0.02);
  EXPECT_LT(scores("close-up", 0.02f)[1], 0.02);
}

TEST(Stability, AMovingFocusDoesNotPop) {
  EXPECT_LT(scores("focus-sweep", 20.0f)[1], 0.005);
  // The sweep crosses the focus where sub-apertures come in, the worst place for popping.
  StabilityTrial longer(sceneNamed("focus-sweep"), 10.0f, {.samples = 48, .steps = 8});
  EXPECT_LT(longer.score("sweep-lod"), 0.0082);
}

TEST(Stability, LightIsNeitherLostNorGained) {
  EXPECT_LT(scores("highlight", 10000.0f)[1], 0.01);
  EXPECT_LT(scores("point-light", 1.0f)[1], 0.01);
  EXPECT_LT(scores("point-light", 10.0f)[1], 0.02);  // a faint disc
  EXPECT_LT(scores("wire", 0.2f)[1], 0.01);
  EXPECT_LT(scores("transparent", 16.0f)[1], 0.01);
}

// The rim of a disc is as soft as the reference's.
TEST(Stability, ADiscHasNoBrightRim) {
  StabilityTrial disc(sceneNamed("firefly"), 100.0f, kShort);
  EXPECT_LT(disc.score("sweep"), 0.15);
}

// foci beats a mean over 0.1 s, which follows noise across the edge; at 250 Hz too, where the mean
// is better.
TEST(Stability, FocusIsSteadyInNoise) {
  for (const std::size_t foci : {0, 3}) {
    for (const char* score : {"gaze-noise", "gaze-noise-jumps"}) {
      EXPECT_LT(observed(score, foci, 1.0f), observed(score, foci + 1, 1.0f) / 3.0)
          << score << " " << foci;
    }
  }
}

// At the extreme of every dial, every pixel is a finite number.
TEST(Stability, ExtremesGiveNumbers) {
  for (const StabilityScene& scene : stabilityScenes()) {
    if (scene.observe) continue;
    const StabilitySetup setup = scene.setup(scene.values.back());
    for (const char* method : {"paper-lod", "sweep-lod"}) {
      Frame frame;
      makeMethod(method, setup.cloud)->render(setup.view, setup.settings, frame);
      EXPECT_TRUE(
          std::all_of(frame.rgba.begin(), frame.rgba.end(),
                      [](const glm::vec4& c) { return std::isfinite(c.r + c.g + c.b + c.a); }))
          << scene.name << ", " << method;
    }
  }
}

}  // namespace
}  // namespace foci
