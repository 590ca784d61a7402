#include "render/methods/discs_of_tiles.h"

#include <cmath>
#include <limits>
#include <utility>

namespace foci {
namespace {

/// Share of the frame that may be beyond the tolerance.
constexpr float kShareBeyond = 0.05f;

/// No tile's typical error is this many times the tolerance: the few that may be beyond it would
/// show single views.
constexpr float kMostOverTolerance = 3.0f;

/// More than three views do not miss cubes.
constexpr float kBeyondThree = 0.75f;

/// The first round aims at this share of the tolerance, so that few need another one. It begins
/// with three discs where their blur errs by at most this (`errorByBlur`).
constexpr float kFirstGoal = 0.93f;

/// Seven discs or more begin where the blur errs by less than this many times the tolerance: most
/// blurred tiles show little detail, and the others are told by their error.
constexpr float kFirstOfMany = 2.0f;

/// A tile's next image has the weight 1 where its error was at least this share beyond the limit.
constexpr float kTransition = 0.25f;

/// The first discs of a layer behind another one, in kDiscs: seven. Its samples are few, so that
/// views take little time, and few views would tell little of the error.
constexpr std::size_t kFirstBehind = 2;

/// A first layer begins with one disc where this is up to so many times the tolerance
/// (`errorByBlur`): most are good enough then, and the others are told by their error.
constexpr float kTryOne = 1.5f;

/// A single disc whose blur errs by less than this share of the tolerance (`errorByBlur`) is not
/// judged.
constexpr float kUnjudged = 0.1f;

/// One disc remains where its error is at most this share of the tile's.
constexpr float kLittle = 0.5f;

/// Halvings of the range up to the largest error that is told from others.
constexpr int kHalvings = 12;
constexpr float kLargest_JND = 64.0f;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();

constexpr std::size_t kLast = kDiscs.size() - 1;

/// Three, or more where the blur is large: no view may reach the rim of a disc of blur, and then
/// none shows an error.
std::size_t firstDiscs(const TileBlur& blur, float tolerance) {
  const auto error = [&](std::size_t index) {
    return errorByBlur(kDiscs[index], {blur.radius_px, false});
  };
  std::size_t first = error(1) <= kFirstGoal * tolerance ? 1 : 2;
  while (first < kLast && error(first) > kFirstOfMany * tolerance) ++first;
  return first;
}

/// What is left of an error for others, which add as squares.
float without(float error, float all) {
  return std::sqrt(std::max(all * all - error * error, 0.0f));
}

/// The largest value up to which `tooLarge` is false, by bisection.
template <typename TooLarge>
float largestThat(const TooLarge& tooLarge) {
  float low = 0.0f, high = kLargest_JND;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = 0.5f * (low + high);
    (tooLarge(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace

void DiscsOfTiles::choose(std::span<const Tile> tiles, const glm::ivec2& size_px,
                          std::span<const TileLayers> layers, std::span<const float> merging,
                          float tolerance) {
  tolerance_ = tolerance;
  area_px2_ = 0.0f;
  is_first_ = true;
  tiles_.assign(tiles.size(), {});
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    TileState& tile = tiles_[t];
    const glm::ivec2 seen_px =
        glm::min(glm::ivec2(tiles[t].side_px), size_px - glm::ivec2(tiles[t].x_px, tiles[t].y_px));
    tile.area_px2 = static_cast<float>(seen_px.x * seen_px.y);
    area_px2_ += tile.area_px2;
    tile.merging = merging[t];
    for (std::size_t k = 0; k < layers[t].count; ++k) {
      const std::size_t first = firstDiscs(layers[t].layers[k].blur, tolerance);
      tile.indices[k] = k == 0 ? first : std::max(first, kFirstBehind);
    }
    const float one = errorByBlur(1, layers[t].layers[0].blur);
    // Errors of layers add as squares.
    const float share = tolerance / std::sqrt(static_cast<float>(layers[t].count));
    if (one <= kTryOne * share) tile.indices[0] = 0;
    tile.is_judged = one > kUnjudged * tolerance;
    if (!tile.is_judged) tile.unjudged = one;
  }
}

DiscsOfTiles::Changes DiscsOfTiles::changesOf(const TileState& tile, const Indices& indices) {
  Changes changes;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const int now = kDiscs[tile.indices[k]], next = kDiscs[indices[k]];
    changes[k] = std::pow(static_cast<float>(next) / static_cast<float>(now), kErrorOrder);
    if (now == 3 && next > 3) changes[k] *= kBeyondThree;
  }
  return changes;
}

template <typename ErrorOf>
float DiscsOfTiles::errorAfter(const TileState& tile, const Changes& changes,
                               const ErrorOf& error_of) {
  float squares = tile.unjudged * tile.unjudged;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const float error = changes[k] * error_of(k);
    squares += error * error;
  }
  return std::sqrt(squares);
}

float DiscsOfTiles::discsThatErr(const TileState& tile, const Indices& indices) {
  float squares = 0.0f, discs = 0.0f;
  for (std::size_t k = 0; k < tile.layers.size(); ++k) {
    const float square = tile.layers[k].typical * tile.layers[k].typical;
    squares += square;
    discs += square * static_cast<float>(kDiscs[indices[k]]);
  }
  return squares > 0.0f ? discs / squares : 1.0f;
}

DiscsOfTiles::Indices DiscsOfTiles::stepFrom(const TileState& tile, Indices indices) {
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const bool errs = indices[k] > 0 || tile.layers[k].typical > kLittle * tile.typical;
    if (errs && indices[k] < kLast) ++indices[k];
  }
  return indices;
}

DiscsOfTiles::Next DiscsOfTiles::nextWithin(const TileState& tile, float limit) const {
  const auto beyond = [&](float error, const Indices& indices) {
    return error / std::min(limit * std::sqrt(discsThatErr(tile, indices)),
                            kMostOverTolerance * tolerance_);
  };
  Next next{.indices = tile.indices};
  float now = beyond(tile.typical, tile.indices);
  if (tile.indices[0] == 0) now = std::max(now, tile.layers[0].typical / tolerance_);
  while (now > 1.0f) {
    const float weight = std::min((now - 1.0f) / kTransition, 1.0f);
    const Indices more = stepFrom(tile, next.indices);
    // An image that is to be mixed with that of the step before waits for it.
    if (more == next.indices || (weight < 1.0f && next.weight == 1.0f)) break;
    next = {more, weight};
    if (weight < 1.0f) break;
    now = beyond(errorAfter(tile, changesOf(tile, more),
                            [&](std::size_t k) { return tile.layers[k].typical; }),
                 more);
  }
  return next;
}

float DiscsOfTiles::areaBeyond_px2(float error, float limit) const {
  float sum_px2 = 0.0f;
  for (const TileState& tile : tiles_) {
    const float highest = without(tile.merging, error);
    if (tile.most <= highest) continue;
    const Next next = nextWithin(tile, limit);
    const Changes none = changesOf(tile, tile.indices);
    const Changes more = changesOf(tile, next.indices);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < tile.samples; ++i) {
      const auto sample = [&](std::size_t k) { return tile.layers[k].errors[i]; };
      float after = errorAfter(tile, none, sample);
      if (next.weight > 0.0f) {
        after = glm::mix(after, errorAfter(tile, more, sample), next.weight);
      }
      beyond += after > highest;
    }
    sum_px2 += tile.area_px2 * static_cast<float>(beyond) / static_cast<float>(tile.samples);
  }
  return sum_px2;
}

void DiscsOfTiles::take(const SampledErrors& sampled, TileState& tile) {
  tile.samples = sampled.count;
  if (tile.indices[0] == 0) tile.of_one = sampled.layers_jnd[0];
  const float left = std::pow(static_cast<float>(kDiscs[tile.indices[0]]), kErrorOrder);
  std::array<float, TileLayers::kMost> most{};
  for (std::size_t k = 0; k < tile.layers.size(); ++k) {
    float squares = 0.0f;
    for (std::size_t i = 0; i < tile.samples; ++i) {
      float now = sampled.layers_jnd[k][i];
      if (k == 0) now = std::max(now, left * tile.of_one[i]);
      float& error = tile.layers[k].errors[i];
      error = glm::mix(error, now, tile.weight);
      squares += error * error;
      most[k] = std::max(most[k], error);
    }
    tile.layers[k].typical = std::sqrt(squares / static_cast<float>(tile.samples));
  }
  const Changes none = changesOf(tile, tile.indices);
  tile.typical = errorAfter(tile, none, [&](std::size_t k) { return tile.layers[k].typical; });
  tile.most = errorAfter(tile, none, [&](std::size_t k) { return most[k]; });
}

bool DiscsOfTiles::refine(const std::vector<SampledErrors>& errors) {
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    if (std::exchange(tiles_[t].is_next, false)) take(errors[t], tiles_[t]);
  }
  const float allowed_px2 = kShareBeyond * area_px2_;
  const float goal = (std::exchange(is_first_, false) ? kFirstGoal : 1.0f) * tolerance_;
  const float limit =
      areaBeyond_px2(goal, kNoLimit) <= allowed_px2
          ? kNoLimit
          : largestThat([&](float each) { return areaBeyond_px2(goal, each) > allowed_px2; });
  bool any = false;
  for (TileState& tile : tiles_) {
    const Next next = nextWithin(tile, limit);
    tile.is_next = next.weight > 0.0f;
    if (!tile.is_next) continue;
    tile.indices = next.indices;
    tile.weight = next.weight;
    any = true;
  }
  return any;
}

float DiscsOfTiles::error() const {
  return largestThat(
      [&](float each) { return areaBeyond_px2(each, kNoLimit) <= kShareBeyond * area_px2_; });
}

}  // namespace foci
