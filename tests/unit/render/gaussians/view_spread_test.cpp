#include "render/gaussians/view_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "render/image/srgb.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

Frame flat(const glm::vec3& rgb) {
  Frame frame;
  frame.resize({4, 4}, false);
  std::fill(frame.rgba.begin(), frame.rgba.end(), glm::vec4(rgb, 1.0f));
  return frame;
}

TEST(VisibleDifferencePerLight, IsTheDifferenceOfASmallChange) {
  constexpr float kSmall = 1e-3f;
  for (const glm::vec3& rgb : {glm::vec3(0.2f), glm::vec3(0.7f, 0.1f, 0.3f), glm::vec3(0.004f)}) {
    for (const glm::vec3& way :
         {glm::vec3(1.0f), glm::vec3(1.0f, 0.0f, 0.0f), glm::vec3(-0.5f, 1.0f, 0.2f)}) {
      const glm::vec3 change = kSmall * way;
      const float shown =
          visibleDifference(flat(rgb + change), flat(rgb - change), kUsualPx_per_deg)[0];
      const float expected = 2.0f * glm::length(visibleDifferencePerLight(rgb) * change);
      EXPECT_NEAR(shown, expected, 0.02f * expected) << rgb.r << " " << rgb.g;
    }
  }
}

constexpr std::size_t kFollowed = 64;  // of a tile whose samples are a pixel apart
const std::vector<BehindSample> kBlack(kFollowed);

class Views {
 public:
  Views() { spread.begin(kTile, 0); }
  /// A view of opaque Gaussians.
  void add(const glm::vec3& light) {
    const SeenLight seen(srgbFromLinear(light.r), srgbFromLinear(light.g), srgbFromLinear(light.b),
                         0.0f);
    std::ranges::fill(spread.next(), seen);
  }
  ViewSpread spread;
};

TEST(ViewSpread, IsZeroForEqualViews) {
  Views views;
  for (int i = 0; i < 3; ++i) views.add(glm::vec3(0.25f, 0.5f, 0.125f));
  EXPECT_EQ(views.spread.places().size(), kFollowed);
  const auto errors = views.spread.standardErrors(kBlack);
  for (std::size_t i = 0; i < kFollowed; ++i) EXPECT_LT(errors[i], 1e-3f);
}

// Means of random views differ from the true mean by the standard error: root mean squares of many
// draws.
TEST(ViewSpread, IsTheErrorOfTheMeanOfRandomViews) {
  constexpr int kDraws = 400, kViews = 5;
  constexpr float kMean = 0.3f, kDeviation = 0.02f;
  std::mt19937 random(3);
  std::normal_distribution<float> normal(kMean, kDeviation);
  double errors2 = 0.0, predicted2 = 0.0;
  const glm::mat3 jnd = visibleDifferencePerLight(glm::vec3(kMean));
  for (int draw = 0; draw < kDraws; ++draw) {
    Views views;
    float sum = 0.0f;
    for (int i = 0; i < kViews; ++i) {
      const float light = normal(random);
      views.add(glm::vec3(light));
      sum += light;
    }
    const float error = glm::length(jnd * glm::vec3(sum / kViews - kMean));
    const float predicted = views.spread.standardErrors(kBlack)[0];
    errors2 += double{error} * double{error};
    predicted2 += double{predicted} * double{predicted};
  }
  EXPECT_NEAR(std::sqrt(predicted2 / errors2), 1.0, 0.1);
}

// What lies behind counts where the Gaussians let it through.
TEST(ViewSpread, SeesWhatLiesBehind) {
  ViewSpread spread;
  spread.begin(kTile, 0);
  std::ranges::fill(spread.next(), SeenLight(0.0f, 0.0f, 0.0f, 1.0f));
  std::ranges::fill(spread.next(), SeenLight(0.0f, 0.0f, 0.0f, 0.0f));
  EXPECT_FLOAT_EQ(spread.transmittance(0), 0.5f);
  EXPECT_LT(spread.standardErrors(kBlack)[0], 1e-3f);
  const std::vector<BehindSample> grey(kFollowed, {.display = glm::vec3(0.5f)});
  EXPECT_GT(spread.standardErrors(grey)[0], 1.0f);
}

/// The sample at a place (`placeOf`).
glm::ivec2 sampleAt(int samples, std::size_t place) {
  const std::size_t square = place / kSquarePlaces, in_square = place % kSquarePlaces;
  return {square % squaresOf(samples) * kSquare + in_square % kSquare,
          square / squaresOf(samples) * kSquare + in_square / kSquare};
}

TEST(ViewSpread, FollowsSamplesInsideOfTheApron) {
  constexpr int kSamples = 8, kAprons = kSamples + 2 * kApron;
  ViewSpread spread;
  spread.begin(kAprons, kApron);
  for (const std::size_t place : spread.places()) {
    const glm::ivec2 sample = sampleAt(kAprons, place);
    EXPECT_GE(std::min(sample.x, sample.y), kApron);
    EXPECT_LT(std::max(sample.x, sample.y), kAprons - kApron);
  }
}

// A part of a coarse tile that is smaller than four samples is not missed.
TEST(ViewSpread, FollowsEverySecondSampleOfACoarseTile) {
  ViewSpread spread;
  spread.begin(kTile + 2 * kApron, kApron);
  EXPECT_EQ(spread.places().size(), std::size_t{kTile} * kTile / 4);
}

// A pixel's centre is half a pixel from its corner, where the samples of layers behind begin.
TEST(ViewSpread, FollowsTheNearestSamplesOfALayerBehind) {
  ViewSpread first;
  first.begin(kTile, 0);
  const TileLayer front{.samples = kTile};
  for (const int step_px : {2, 4, 8}) {
    const TileLayer layer{.step_px = step_px, .samples = kTile / step_px + 1};
    ViewSpread behind;
    behind.beginBehind(first, front, layer);
    ASSERT_EQ(behind.places().size(), first.places().size());
    for (std::size_t i = 0; i < first.places().size(); ++i) {
      const auto at_px = static_cast<float>(sampleAt(kTile, first.places()[i]).x) + 0.5f;
      const int sample = sampleAt(layer.samples, behind.places()[i]).x;
      const auto step = static_cast<float>(step_px);
      EXPECT_LE(std::abs(static_cast<float>(sample) * step - at_px), 0.5f * step);
    }
  }
}

}  // namespace
}  // namespace foci
