#include "render/gaussians/view_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "render/image/metrics.h"
#include "render/image/srgb.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lens_samples.h"

namespace foci {
namespace FOCI_FILE {

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

constexpr float kBlur_px = 10.0f;

TEST(ViewSpread, IsZeroForEqualViews) {
  for (const int n : {3, 7}) {
    Views views;
    for (int i = 0; i < n; ++i) views.add(glm::vec3(0.25f, 0.5f, 0.125f));
    EXPECT_EQ(views.spread.places().size(), kFollowed);
    const auto errors = views.spread.errorsOfMean(subApertureDiscs(n), kBlur_px, kBlack);
    for (std::size_t i = 0; i < kFollowed; ++i) EXPECT_LT(errors[i], 1e-3f) << n;
  }
}

// The discs integrate quadrics over the lens without error, however far the views lie apart.
TEST(ViewSpread, IsZeroForQuadrics) {
  for (const int n : {7, 13, 37}) {
    const std::vector<LensDisc> discs = subApertureDiscs(n);
    Views views;
    for (const LensDisc& disc : discs) {
      const glm::vec2 p = disc.centre;
      views.add(glm::vec3(0.4f + 0.1f * p.x - 0.05f * p.y + 0.08f * p.x * p.x - 0.06f * p.x * p.y));
    }
    EXPECT_LT(views.spread.errorsOfMean(discs, kBlur_px, kBlack)[0], 0.02f) << n;
  }
}

/// Share of the unit disc beyond a chord at this distance from the centre.
double areaBeyond(double at) {
  return (std::acos(at) - at * std::sqrt(1.0 - at * at)) / std::numbers::pi;
}

/// The prediction over the error, as root mean squares, of tiles that see an edge at another place
/// of the lens at each of their samples: along another normal, up to `farthest` from the middle.
/// @param share  of the bright side at a distance along the normal, by the edge's
/// @param truth  its mean over the lens, by the normal and the edge's distance
template <typename Share, typename Truth>
double ratioOfEdges(int n, float blur_px, float farthest, const Share& share, const Truth& truth) {
  constexpr int kTiles = 20;
  constexpr float kDark = 0.3f, kBright = 0.32f;
  const float jnd = glm::length(visibleDifferencePerLight(glm::vec3(kDark)) * glm::vec3(1.0f));
  const std::vector<LensDisc> discs = subApertureDiscs(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  double errors2 = 0.0, predicted2 = 0.0;
  for (int tile = 0; tile < kTiles; ++tile) {
    std::array<glm::vec2, kFollowed> normals;
    std::array<float, kFollowed> at, mean{};
    for (std::size_t i = 0; i < kFollowed; ++i) {
      normals[i] = onCircle(unit(random));
      at[i] = farthest * (2.0f * unit(random) - 1.0f);
    }
    Views views;
    for (const LensDisc& disc : discs) {
      const std::span<SeenLight> seen = views.spread.next();
      for (std::size_t i = 0; i < kFollowed; ++i) {
        const float bright = share(glm::dot(disc.centre, normals[i]), at[i]);
        const float shown = srgbFromLinear(glm::mix(kDark, kBright, bright));
        seen[i] = {shown, shown, shown, 0.0f};
        mean[i] += bright / static_cast<float>(n);
      }
    }
    const auto predicted = views.spread.errorsOfMean(discs, blur_px, kBlack);
    for (std::size_t i = 0; i < kFollowed; ++i) {
      const double error = jnd * (kBright - kDark) * (mean[i] - truth(normals[i], at[i]));
      errors2 += error * error;
      predicted2 += double{predicted[i]} * double{predicted[i]};
    }
  }
  return std::sqrt(predicted2 / errors2);
}

TEST(ViewSpread, TellsTheErrorOfEdges) {
  constexpr float kLarge_px = 30.0f;
  for (const int n : {3, 7, 19, 61, 127}) {
    const double ratio = ratioOfEdges(
        n, kLarge_px, 1.0f, [](float along, float at) { return along > at ? 1.0f : 0.0f; },
        [](const glm::vec2&, float at) { return areaBeyond(at); });
    EXPECT_GE(ratio, n == 3 ? 2.0 : 0.85) << n;
    EXPECT_LE(ratio, n == 3 ? 3.0 : 1.0) << n;
  }
}

// Edges of the image that are as soft as a pixel: the smaller the blur, the more of them three
// discs integrate. The mean over the lens is a sum over many points.
TEST(ViewSpread, TellsTheErrorOfSoftEdgesByTheBlur) {
  constexpr int kMany = 2000;
  constexpr float kSoft_px = 1.0f;
  for (const float blur_px : {2.0f, 4.0f, 8.0f}) {
    const auto share = [&](float along, float at) {
      const float px = blur_px * (along - at);
      return 0.5f + 0.5f * std::erf(px / (kSoft_px * std::numbers::sqrt2_v<float>));
    };
    const auto truth = [&](const glm::vec2& normal, float at) {
      double sum = 0.0;
      for (int k = 0; k < kMany; ++k) {
        sum += double{share(glm::dot(lensSample(k, kMany), normal), at)};
      }
      return sum / kMany;
    };
    for (const int n : {3, 7}) {
      if (n > 3 && blur_px < 4.0f) continue;  // hardly any error
      const double ratio = ratioOfEdges(n, blur_px, 1.0f + 2.0f * kSoft_px / blur_px, share, truth);
      EXPECT_GE(ratio, n == 3 ? 2.5 : 0.8) << n << ' ' << blur_px;
      EXPECT_LE(ratio, n == 3 ? 3.0 : 1.1) << n << ' ' << blur_px;
    }
  }
}

TEST(ViewSpread, AViewErrsByItsDistanceFromItsJudges) {
  Views one, three;
  one.add(glm::vec3(0.25f));
  for (const float light : {0.1f, 0.2f, 0.3f}) three.add(glm::vec3(light));
  const glm::vec3 apart = visibleDifferencePerLight(glm::vec3(0.2f)) * glm::vec3(0.05f);
  const auto errors = one.spread.errorsOfOne(three.spread, kBlack);
  for (std::size_t i = 0; i < kFollowed; ++i)
    EXPECT_NEAR(errors[i], 1.1f * glm::length(apart), 1e-3f);
}

// What lies behind counts where the Gaussians let it through.
TEST(ViewSpread, SeesWhatLiesBehind) {
  ViewSpread spread;
  spread.begin(kTile, 0);
  std::ranges::fill(spread.next(), SeenLight(0.0f, 0.0f, 0.0f, 1.0f));
  for (int i = 0; i < 2; ++i) std::ranges::fill(spread.next(), SeenLight(0.0f));
  EXPECT_FLOAT_EQ(spread.transmittance(0), 1.0f / 3.0f);
  const std::vector<LensDisc> discs = subApertureDiscs(3);
  EXPECT_LT(spread.errorsOfMean(discs, kBlur_px, kBlack)[0], 1e-3f);
  const std::vector<BehindSample> grey(kFollowed, {.display = glm::vec3(0.5f)});
  EXPECT_GT(spread.errorsOfMean(discs, kBlur_px, grey)[0], 1.0f);
}

/// Column and row of the sample at a place.
glm::ivec2 sampleAt(std::size_t place, int samples) {
  const std::size_t square = place / kSquarePlaces, in_square = place % kSquarePlaces;
  const std::size_t squares = squaresOf(samples);
  return {static_cast<int>(square % squares * kSquare + in_square % kSquare),
          static_cast<int>(square / squares * kSquare + in_square / kSquare)};
}

TEST(ViewSpread, FollowsSamplesInsideOfTheApron) {
  constexpr int kSamples = 8, kAprons = kSamples + 2 * kApron;
  ViewSpread spread;
  spread.begin(kAprons, kApron);
  for (const std::size_t place : spread.places()) {
    const glm::ivec2 sample = sampleAt(place, kAprons);
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
      const auto at_px = static_cast<float>(sampleAt(first.places()[i], kTile).x) + 0.5f;
      const auto sample = sampleAt(behind.places()[i], layer.samples).x;
      const auto step = static_cast<float>(step_px);
      EXPECT_LE(std::abs(static_cast<float>(sample) * step - at_px), 0.5f * step);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
