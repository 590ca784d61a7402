#include "render/methods/discs_of_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace foci {
namespace {

/// Share of the frame that may be beyond the tolerance.
constexpr float kShareBeyond = 0.05f;

/// No sample's error is this many times the tolerance: the few that may be beyond it would show
/// single views.
constexpr float kMostOverTolerance = 3.0f;

/// The error of the mean of n views of an edge falls as n to this power (a fit from 3 to 91).
constexpr float kEdgeOrder = -0.77f;

/// A tile's next number of discs is chosen for this share of its limit, since errors vary.
constexpr float kAim = 0.9f;

/// A tile's next image has the weight 1 where its error was at least this share beyond the limit.
constexpr float kTransition = 0.25f;

/// The first discs of a layer behind another one, in kDiscs: seven. Its samples are few, so that
/// views take little time, and few views would tell little of the error.
constexpr std::size_t kFirstBehind = 2;

/// Halvings of the range up to the largest error that is told from others.
constexpr int kHalvings = 12;
constexpr float kLargest_JND = 64.0f;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();

/// The first of kDiscs whose bound by the blur radius is within the tolerance, or the last.
std::size_t discsWithin(const TileBlur& blur, float tolerance) {
  const auto enough = std::ranges::find_if(
      kDiscs, [&](const Discs& discs) { return errorOf(discs, blur) <= tolerance; });
  return static_cast<std::size_t>(std::min(enough, kDiscs.end() - 1) - kDiscs.begin());
}

/// Three, or more where the blur is large: no view may reach the rim of a disc of blur, and then
/// none shows an error.
std::size_t firstDiscs(const TileBlur& blur, float tolerance) {
  return std::max<std::size_t>(discsWithin({blur.radius_px, false}, 2.0f * tolerance), 1);
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
  tiles_.assign(tiles.size(), {});
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    TileState& tile = tiles_[t];
    const glm::ivec2 seen_px =
        glm::min(glm::ivec2(tiles[t].side_px), size_px - glm::ivec2(tiles[t].x_px, tiles[t].y_px));
    tile.area_px2 = static_cast<float>(seen_px.x * seen_px.y);
    area_px2_ += tile.area_px2;
    tile.merging = merging[t];
    const std::size_t count = layers[t].count;
    // Errors of layers add as squares.
    const float share = 1.0f / std::sqrt(static_cast<float>(count));
    for (std::size_t k = 0; k < count; ++k) {
      LayerState& layer = tile.layers[k];
      layer.blur = layers[t].layers[k].blur;
      layer.time = layers[t].layers[k].time;
      layer.last = discsWithin(layer.blur, share * tolerance - tile.merging);
      const std::size_t first = firstDiscs(layer.blur, tolerance);
      tile.indices[k] = std::min(k == 0 ? first : std::max(first, kFirstBehind), layer.last);
    }
  }
}

DiscsOfTiles::Change DiscsOfTiles::changeOf(const TileState& tile, std::size_t layer,
                                            std::size_t index) {
  const float bound = errorOf(kDiscs[index], tile.layers[layer].blur);
  if (tile.indices[layer] == 0) return {std::nullopt, bound};
  const float more = static_cast<float>(kDiscs[index].count) /
                     static_cast<float>(kDiscs[tile.indices[layer]].count);
  return {std::pow(more, kEdgeOrder), bound};
}

DiscsOfTiles::Changes DiscsOfTiles::changesOf(const TileState& tile, const Indices& indices) {
  Changes changes;
  for (std::size_t k = 0; k < indices.size(); ++k) changes[k] = changeOf(tile, k, indices[k]);
  return changes;
}

template <typename ErrorOf>
float DiscsOfTiles::errorAfter(const Changes& changes, const TileState& tile,
                               const ErrorOf& error_of) {
  float squares = 0.0f;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const float error = changes[k].of(error_of(tile.layers[k]));
    squares += error * error;
  }
  return std::sqrt(squares);
}

DiscsOfTiles::Next DiscsOfTiles::nextWithin(const TileState& tile, float limit) const {
  Next next{.indices = tile.indices};
  // Over what they may be.
  const auto excess = [&] {
    const Changes changes = changesOf(tile, next.indices);
    const float typical =
        errorAfter(changes, tile, [](const LayerState& layer) { return layer.typical; });
    const float most =
        errorAfter(changes, tile, [](const LayerState& layer) { return layer.most; });
    return std::max(typical / limit, most / (kMostOverTolerance * tolerance_));
  };
  const float now = excess();
  if (now <= 1.0f) return next;
  // Once only, or rounds would follow that change little.
  next.weight = tile.refined ? 1.0f : std::min((now - 1.0f) / kTransition, 1.0f);
  while (excess() > kAim) {
    // The time is least where squared errors are in proportion to times.
    std::optional<std::size_t> best;
    float largest = -1.0f;
    for (std::size_t k = 0; k < next.indices.size(); ++k) {
      const LayerState& layer = tile.layers[k];
      if (next.indices[k] == layer.last) continue;
      const float error = changeOf(tile, k, next.indices[k]).of(layer.typical);
      const float worth =
          error * error / (layer.time * static_cast<float>(kDiscs[next.indices[k]].count));
      if (worth > largest) {
        largest = worth;
        best = k;
      }
    }
    if (!best) break;
    ++next.indices[*best];
  }
  if (next.indices == tile.indices) next.weight = 0.0f;
  return next;
}

float DiscsOfTiles::areaBeyond_px2(float error, float limit) const {
  float sum_px2 = 0.0f;
  for (const TileState& tile : tiles_) {
    const float highest = error - tile.merging;
    const Changes none = changesOf(tile, tile.indices);
    const float most = errorAfter(none, tile, [](const LayerState& layer) { return layer.most; });
    if (most <= highest) continue;
    const Next next = nextWithin(tile, limit);
    const Changes more = changesOf(tile, next.indices);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < tile.samples; ++i) {
      const auto sample = [&](const LayerState& layer) { return layer.errors[i]; };
      float after = errorAfter(none, tile, sample);
      if (next.weight > 0.0f) {
        after = glm::mix(after, errorAfter(more, tile, sample), next.weight);
      }
      beyond += after > highest;
    }
    sum_px2 += tile.area_px2 * static_cast<float>(beyond) / static_cast<float>(tile.samples);
  }
  return sum_px2;
}

void DiscsOfTiles::take(const SampledErrors& sampled, TileState& tile) {
  tile.samples = sampled.count;
  for (std::size_t k = 0; k < tile.layers.size(); ++k) {
    LayerState& layer = tile.layers[k];
    const Discs& discs = kDiscs[tile.indices[k]];
    const float bound = errorOf(discs, layer.blur);
    float squares = 0.0f;
    layer.most = 0.0f;
    for (std::size_t i = 0; i < tile.samples; ++i) {
      const float error = std::min(discs.error_share * sampled.layers_jnd[k][i], bound);
      layer.errors[i] = glm::mix(layer.errors[i], error, tile.weight);
      squares += layer.errors[i] * layer.errors[i];
      layer.most = std::max(layer.most, layer.errors[i]);
    }
    layer.typical = std::sqrt(squares / static_cast<float>(tile.samples));
  }
}

bool DiscsOfTiles::refine(const std::vector<SampledErrors>& standard_errors) {
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    if (std::exchange(tiles_[t].is_next, false)) take(standard_errors[t], tiles_[t]);
  }
  const float allowed_px2 = kShareBeyond * area_px2_;
  const float limit =
      areaBeyond_px2(tolerance_, kNoLimit) <= allowed_px2
          ? kNoLimit
          : largestThat([&](float each) { return areaBeyond_px2(tolerance_, each) > allowed_px2; });
  bool any = false;
  for (TileState& tile : tiles_) {
    const Next next = nextWithin(tile, limit);
    tile.is_next = next.weight > 0.0f;
    if (!tile.is_next) continue;
    tile.indices = next.indices;
    tile.weight = next.weight;
    tile.refined = true;
    any = true;
  }
  return any;
}

float DiscsOfTiles::error() const {
  return largestThat(
      [&](float each) { return areaBeyond_px2(each, kNoLimit) <= kShareBeyond * area_px2_; });
}

}  // namespace foci
