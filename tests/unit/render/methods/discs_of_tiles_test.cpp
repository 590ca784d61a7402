#include "render/methods/discs_of_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace foci {
namespace FOCI_FILE {

/// Discs that a tile of one layer with this blur begins with.
constexpr int kFirst = 7;
constexpr float kBlur_px = 15.0f;

TileLayers oneLayer(float blur_px) {
  TileLayers layers;
  layers.layers[0] = {.size = 1, .samples = kTile, .blur = {blur_px, false}};
  return layers;
}

/// 10 x 10 tiles with these layers, whose views err alike in the first `detailed` of them.
class Tiles {
 public:
  explicit Tiles(float blur_px, float tolerance = 1.0f) : Tiles(oneLayer(blur_px), tolerance) {}
  explicit Tiles(const TileLayers& layers, float tolerance = 1.0f) {
    std::vector<Tile> tiles;
    for (int i = 0; i < kTiles; ++i) {
      tiles.push_back({.x_px = i % 10 * kTile, .y_px = i / 10 * kTile});
    }
    discs.choose(tiles, glm::ivec2(10 * kTile), std::vector<TileLayers>(kTiles, layers),
                 std::vector<float>(kTiles, 0.0f), tolerance);
  }

  /// The error falls as that of an edge. @return rounds
  int render(int detailed, float error_of_one, std::size_t layer = 0) {
    int rounds = 0;
    std::vector<SampledErrors> errors(kTiles);
    do {
      for (int t = 0; t < kTiles; ++t) {
        SampledErrors& each = errors[static_cast<std::size_t>(t)];
        const auto views = static_cast<float>(countOf(t, layer));
        each.count = SampledErrors::kMost;
        each.layers_jnd[layer].fill(t < detailed ? error_of_one * std::pow(views, -0.8f) : 0.0f);
      }
      ++rounds;
    } while (discs.refine(errors));
    return rounds;
  }

  int countOf(int tile, std::size_t layer = 0) const {
    return kDiscs[discs.indexOf(static_cast<std::size_t>(tile), layer)];
  }

  static constexpr int kTiles = 100;
  DiscsOfTiles discs;
};

TEST(DiscsOfTiles, TakesOneDiscWhereTheBlurIsSmall) {
  Tiles tiles(1.0f);
  EXPECT_EQ(tiles.countOf(0), 1);
  EXPECT_TRUE(tiles.discs.isJudged(0));
  EXPECT_EQ(tiles.render(Tiles::kTiles, 0.7f), 1);
  EXPECT_EQ(tiles.countOf(0), 1);
  EXPECT_NEAR(tiles.discs.error(), 0.7f, 0.02f);
}

TEST(DiscsOfTiles, DoesNotJudgeOneDiscOfHardlyAnyBlur) {
  Tiles tiles(0.1f);
  EXPECT_FALSE(tiles.discs.isJudged(0));
  EXPECT_EQ(tiles.render(0, 0.0f), 1);
  EXPECT_NEAR(tiles.discs.error(), 0.05f, 0.02f);
}

// However few they are.
TEST(DiscsOfTiles, GivesMoreWhereOneDiscErrsBeyondTheTolerance) {
  Tiles tiles(1.0f);
  EXPECT_EQ(tiles.render(4, 2.0f), 2);
  EXPECT_EQ(tiles.countOf(0), 3);
  EXPECT_FALSE(tiles.discs.isJudged(0));
  EXPECT_EQ(tiles.countOf(99), 1);
}

// Views may agree and err alike: each disc blurs by itself, as the one did.
TEST(DiscsOfTiles, RemembersTheErrorOfOneDisc) {
  Tiles tiles(1.0f);
  std::vector<SampledErrors> errors(Tiles::kTiles);
  for (SampledErrors& each : errors) {
    each.count = SampledErrors::kMost;
    each.layers_jnd[0].fill(2.0f);
  }
  ASSERT_TRUE(tiles.discs.refine(errors));
  EXPECT_EQ(tiles.countOf(0), 3);
  for (SampledErrors& each : errors) each.layers_jnd[0].fill(0.0f);
  EXPECT_FALSE(tiles.discs.refine(errors));
  EXPECT_NEAR(tiles.discs.error(), 2.0f * std::pow(3.0f, -0.8f), 0.02f);
}

TEST(DiscsOfTiles, BeginsWithThreeWhereTheBlurIsModerate) {
  EXPECT_EQ(Tiles(2.9f).countOf(0), 1);
  EXPECT_EQ(Tiles(4.0f).countOf(0), 3);
  EXPECT_EQ(Tiles(5.0f).countOf(0), 7);
}

TEST(DiscsOfTiles, TakesFewWhereNothingShowsTheBlur) {
  Tiles tiles(kBlur_px);
  EXPECT_EQ(tiles.render(0, 0.0f), 1);
  EXPECT_EQ(tiles.countOf(0), kFirst);
  EXPECT_LT(tiles.discs.error(), 0.02f);
}

TEST(DiscsOfTiles, LeavesAFewTilesBeyondTheTolerance) {
  Tiles tiles(kBlur_px);
  EXPECT_EQ(tiles.render(4, 10.0f), 1);
  EXPECT_EQ(tiles.countOf(0), kFirst);
  EXPECT_LE(tiles.discs.error(), 1.0f);
}

TEST(DiscsOfTiles, LeavesNoTileFarBeyondTheTolerance) {
  Tiles tiles(kBlur_px);
  EXPECT_GT(tiles.render(4, 20.0f), 1);
  EXPECT_GT(tiles.countOf(0), kFirst);
  EXPECT_EQ(tiles.countOf(99), kFirst);
}

TEST(DiscsOfTiles, GivesMoreDiscsToDetailOnly) {
  Tiles tiles(kBlur_px);
  EXPECT_GT(tiles.render(10, 20.0f), 1);
  EXPECT_GT(tiles.countOf(0), kFirst);
  EXPECT_EQ(tiles.countOf(99), kFirst);
  EXPECT_LE(tiles.discs.error(), 1.0f);
}

// What a round in between would render is not seen.
TEST(DiscsOfTiles, GivesTheDiscsThatTheErrorNeedsInOneRound) {
  Tiles tiles(kBlur_px);
  EXPECT_EQ(tiles.render(10, 20.0f), 2);
  EXPECT_EQ(tiles.countOf(0), 61);
}

TEST(DiscsOfTiles, ASmallerToleranceTakesMoreDiscs) {
  int last = 0;
  for (const float tolerance : {4.0f, 1.0f, 0.4f}) {
    Tiles tiles(kBlur_px, tolerance);
    tiles.render(Tiles::kTiles, 10.0f);
    EXPECT_GT(tiles.countOf(0), last) << tolerance;
    EXPECT_LE(tiles.discs.error(), tolerance);
    last = tiles.countOf(0);
  }
}

/// A sharp layer before two blurred ones.
TileLayers threeLayers() {
  TileLayers layers{.layers = {}, .count = 3};
  layers.layers[0] = {.size = 1, .samples = kTile, .blur = {0.5f, false}};
  layers.layers[1] = {.size = 1, .step_px = 2, .samples = 17, .blur = {6.0f, false}};
  layers.layers[2] = {.size = 1, .step_px = 4, .samples = 9, .blur = {16.0f, false}};
  return layers;
}

TEST(DiscsOfTiles, BlurredLayersBeginWithMoreDiscsThanASharpOne) {
  const Tiles tiles(threeLayers());
  EXPECT_EQ(tiles.countOf(0, 0), 1);
  EXPECT_EQ(tiles.countOf(0, 1), 7);
  EXPECT_EQ(tiles.countOf(0, 2), 7);
}

TEST(DiscsOfTiles, GivesMoreDiscsToBlurredLayersWhereOneErrs) {
  Tiles tiles(threeLayers(), 0.9f);
  tiles.render(10, 15.0f, 2);
  EXPECT_EQ(tiles.countOf(0, 0), 1);
  EXPECT_GT(tiles.countOf(0, 1), 7);
  EXPECT_GT(tiles.countOf(0, 2), 7);
  EXPECT_LE(tiles.discs.error(), 0.9f);
}

// More discs take less time there.
TEST(DiscsOfTiles, GivesMoreFirstToTilesOfFewDiscs) {
  constexpr std::size_t kOfFew = 8, kOfMany = 4;  // tiles; five may stay beyond the tolerance
  std::vector<Tile> tiles;
  std::vector<TileLayers> layers;
  for (int i = 0; i < Tiles::kTiles; ++i) {
    tiles.push_back({.x_px = i % 10 * kTile, .y_px = i / 10 * kTile});
    layers.push_back(oneLayer(
        layers.size() < kOfFew + kOfMany && layers.size() >= kOfFew ? 2.0f * kBlur_px : kBlur_px));
  }
  DiscsOfTiles discs;
  discs.choose(tiles, glm::ivec2(10 * kTile), layers, std::vector<float>(tiles.size(), 0.0f), 1.0f);
  ASSERT_EQ(kDiscs[discs.indexOf(0, 0)], kFirst);
  ASSERT_EQ(kDiscs[discs.indexOf(kOfFew, 0)], 19);
  std::vector<SampledErrors> errors(tiles.size());
  for (SampledErrors& each : errors) each.count = SampledErrors::kMost;
  for (std::size_t t = 0; t < kOfFew; ++t) errors[t].layers_jnd[0].fill(1.5f);
  for (std::size_t t = kOfFew; t < kOfFew + kOfMany; ++t) errors[t].layers_jnd[0].fill(1.8f);
  ASSERT_TRUE(discs.refine(errors));
  EXPECT_TRUE(discs.isNext(0));
  EXPECT_FALSE(discs.isNext(kOfFew));
}

// An error a little beyond the limit changes a tile a little.
TEST(DiscsOfTiles, MoreDiscsWeighMoreTheLargerTheErrorIs) {
  std::vector<float> weights;
  for (const float worse : {0.0f, 0.1f, 2.0f}) {
    Tiles tiles(kBlur_px);
    std::vector<SampledErrors> errors(Tiles::kTiles);
    // Those of six tiles are beyond the tolerance; one more than may be.
    for (int t = 0; t < 6; ++t) {
      SampledErrors& each = errors[static_cast<std::size_t>(t)];
      each.layers_jnd[0].fill(1.05f + (t == 0 ? worse : 0.0f));
    }
    for (SampledErrors& each : errors) each.count = SampledErrors::kMost;
    EXPECT_TRUE(tiles.discs.refine(errors));
    weights.push_back(tiles.discs.weightOf(0));
    EXPECT_EQ(tiles.discs.weightOf(99), 1.0f);  // not rendered again
    EXPECT_FALSE(tiles.discs.isNext(99));
  }
  EXPECT_LT(weights[0], weights[1]);
  EXPECT_LT(weights[1], weights[2]);
  EXPECT_EQ(weights[2], 1.0f);
}

}  // namespace FOCI_FILE
}  // namespace foci
