#include "render/gaussians/view_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

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

class Views {
 public:
  Views() { spread.begin(kTile, 0); }
  void add(const glm::vec3& light) {
    for (std::size_t p = 0; p < kTilePlaces; ++p) {
      sums->red[p] += light.r;
      sums->green[p] += light.g;
      sums->blue[p] += light.b;
    }
    spread.add(*sums);
  }
  std::unique_ptr<TileSums> sums = std::make_unique<TileSums>();
  ViewSpread spread;
};

TEST(ViewSpread, IsZeroForEqualViews) {
  Views views;
  for (int i = 0; i < 3; ++i) views.add(glm::vec3(0.25f, 0.5f, 0.125f));
  const SampledErrors errors = views.spread.standardErrors();
  EXPECT_EQ(errors.count, SampledErrors::kMost);
  for (const float each : errors.all()) EXPECT_LT(each, 1e-3f);
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
    const float predicted = views.spread.standardErrors().jnd[0];
    errors2 += double{error} * double{error};
    predicted2 += double{predicted} * double{predicted};
  }
  EXPECT_NEAR(std::sqrt(predicted2 / errors2), 1.0, 0.1);
}

TEST(ViewSpread, FollowsSamplesInsideOfTheApron) {
  constexpr int kSamples = 8, kAprons = kSamples + 2 * kApron;
  auto sums = std::make_unique<TileSums>();
  ViewSpread spread;
  spread.begin(kAprons, kApron);
  for (int view = 0; view < 2; ++view) {
    for (int y = 0; y < kAprons; ++y) {
      for (int x = 0; x < kAprons; ++x) {
        const bool inside = std::min(x, y) >= kApron && std::max(x, y) < kAprons - kApron;
        sums->red[static_cast<std::size_t>(y) * rowOf(kAprons) + static_cast<std::size_t>(x)] +=
            inside ? 0.5f : static_cast<float>(view);
      }
    }
    spread.add(*sums);
  }
  const SampledErrors errors = spread.standardErrors();
  for (const float each : errors.all()) EXPECT_EQ(each, 0.0f);
}

}  // namespace
}  // namespace foci
