#include "render/gaussians/tile_layers.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace foci {
namespace {

/// One more layer is worth it where it takes at most this share of the time.
constexpr float kWorthwhile = 0.85f;

class BlurSum {
 public:
  void add(float blur_px, float opacity) {
    const double blur2 = double{blur_px} * double{blur_px};
    const double peak = std::min(opacity, 1.0f);
    sum_ += peak * blur2 * blur2;
    weights_ += peak;
    ++count_;
  }
  BlurSum without(const BlurSum& other) const {
    BlurSum rest = *this;
    rest.sum_ = std::max(sum_ - other.sum_, 0.0);
    rest.weights_ = std::max(weights_ - other.weights_, 0.0);
    rest.count_ -= other.count_;
    return rest;
  }
  float radius_px() const {
    return weights_ > 0.0 ? static_cast<float>(std::sqrt(std::sqrt(sum_ / weights_))) : 0.0f;
  }
  std::size_t count() const { return count_; }

 private:
  double sum_ = 0.0, weights_ = 0.0;
  std::size_t count_ = 0;
};

constexpr float kError_per_px = 0.5f, kErrorEverywhere_per_px = 0.9f;

/// Views that leave an error of 1 JND, and three at least.
float viewsFor(float radius_px) {
  constexpr float kFewest = 3.0f;
  return std::max(kFewest, std::pow(kError_per_px * radius_px, -1.0f / kErrorOrder));
}

/// The last Gaussians whose samples may be `step_px` apart.
struct Suffix {
  int step_px;
  std::optional<BlurSum> sum = {};  ///< none yet
};

/// @param samples  along a side
TileLayer layerOf(int step_px, int samples, const BlurSum& sum) {
  return {.size = sum.count(),
          .step_px = step_px,
          .samples = samples,
          .blur = {sum.radius_px(), false}};
}

/// In a unit of its own.
float timeOf(const TileLayer& layer) {
  const float share = static_cast<float>(layer.samples) / static_cast<float>(kTile);
  return share * share * static_cast<float>(layer.size) * viewsFor(layer.blur.radius_px);
}

}  // namespace

float errorByBlur(int discs, const TileBlur& blur) {
  return (blur.everywhere ? kErrorEverywhere_per_px : kError_per_px) * blur.radius_px *
         std::pow(static_cast<float>(discs), kErrorOrder);
}

TileBlur blurOf(const Tile& tile, std::span<const std::uint32_t> list,
                const ProjectedGaussians& projected) {
  BlurSum all;
  for (const std::uint32_t i : list) {
    all.add(projected.chunks.keys[i].blur_px, projected.gaussians[i].opacity);
  }
  return {.radius_px = all.radius_px(), .everywhere = tile.step_px > 1};
}

TileLayers oneLayer(const Tile& tile, std::size_t size) {
  TileLayers layers;
  layers.layers[0].size = size;
  layers.layers[0].step_px = tile.step_px;
  layers.layers[0].samples = tile.samplesWithApron();
  return layers;
}

namespace {

/// @param at  the k-th of the tile's `size` Gaussians; called from the last one on
template <typename At>
TileLayers divide(const Tile& tile, std::size_t size, const At& at, const glm::ivec2& size_px) {
  static_assert(kMaxStep_px == 8);
  std::array suffixes{Suffix{.step_px = 2}, Suffix{.step_px = 4}, Suffix{.step_px = 8}};
  BlurSum all;
  for (std::size_t k = size; k-- > 0;) {
    const ListedGaussian gaussian = at(k);
    for (Suffix& each : suffixes) {
      if (!each.sum && gaussian.step_px < each.step_px) each.sum = all;
    }
    all.add(gaussian.blur_px, gaussian.opacity);
  }
  for (Suffix& each : suffixes) {
    if (!each.sum) each.sum = all;
  }
  // Samples lie from edge to edge, but not beyond the frame's edge: they would miss what is there.
  const glm::ivec2 seen_px =
      glm::min(glm::ivec2(kTile), size_px - glm::ivec2(tile.x_px, tile.y_px));
  const auto fits = [&](const Suffix& suffix) {
    return suffix.sum->count() > 0 && seen_px.x % suffix.step_px == 0 &&
           seen_px.y % suffix.step_px == 0;
  };
  TileLayers best;
  std::optional<float> least;
  const auto consider = [&](std::span<const Suffix* const> behind) {
    TileLayers layers{.layers = {}, .count = behind.size() + 1};
    float time = 0.0f, worthwhile = 1.0f;
    BlurSum rest = all;
    for (std::size_t k = 0; k < layers.count; ++k) {
      const Suffix* const next = k < behind.size() ? behind[k] : nullptr;
      const int step_px = k == 0 ? 1 : behind[k - 1]->step_px;
      const int samples = k == 0 ? kTile : kTile / step_px + 1;
      layers.layers[k] = layerOf(step_px, samples, next ? rest.without(*next->sum) : rest);
      if (k > 0 && layers.layers[k].size == 0) return;
      if (next) rest = *next->sum;
      time += timeOf(layers.layers[k]);
      if (k > 0) worthwhile *= kWorthwhile;
    }
    if (least && !(time < worthwhile * *least)) return;
    least = time / worthwhile;
    best = layers;
  };
  consider({});
  for (std::size_t i = 0; i < suffixes.size(); ++i) {
    if (!fits(suffixes[i])) continue;
    consider(std::array<const Suffix*, 1>{&suffixes[i]});
    for (std::size_t k = i + 1; k < suffixes.size(); ++k) {
      if (fits(suffixes[k])) consider(std::array<const Suffix*, 2>{&suffixes[i], &suffixes[k]});
    }
  }
  return best;
}

}  // namespace

TileLayers layersOf(const Tile& tile, std::span<const std::uint32_t> list,
                    const ProjectedGaussians& projected, const glm::ivec2& size_px) {
  return divide(
      tile, list.size(),
      [&](std::size_t k) {
        constexpr std::size_t kAhead = 16;  // entries lie scattered in memory; the last come first
        if (k >= kAhead) {
          __builtin_prefetch(&projected.chunks.keys[list[k - kAhead]]);
          __builtin_prefetch(&projected.gaussians[list[k - kAhead]]);
        }
        const SplatKey& key = projected.chunks.keys[list[k]];
        const ProjectedGaussian& gaussian = projected.gaussians[list[k]];
        return ListedGaussian{.blur_px = key.blur_px,
                              .opacity = gaussian.opacity,
                              .step_px = gaussian.off_D > 0.0f ? stepFor(key.sigma_px) : 1};
      },
      size_px);
}

TileLayers layersOf(const Tile& tile, std::span<const ListedGaussian> list,
                    const glm::ivec2& size_px) {
  return divide(
      tile, list.size(), [&](std::size_t k) { return list[k]; }, size_px);
}

}  // namespace foci
