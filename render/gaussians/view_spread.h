// How far the views of a tile through sub-apertures lie apart. `auto` judges the error of their
// mean by it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/gaussians/tile_layers.h"

namespace foci {

/// Standard errors at the samples that are followed, in just-noticeable differences.
struct SampledErrors {
  static constexpr std::size_t kMost = 256;
  /// By layer of the tile; those behind the first as far as they show.
  std::array<std::array<float, kMost>, TileLayers::kMost> layers_jnd{};
  std::size_t count = 0;
};

/// What lies behind a sample, the same for all views.
struct BehindSample {
  glm::vec3 display{0.0f};  ///< display value
  glm::vec3 light{0.0f};    ///< mean linear light, less that of the display value
};

/// Follows a tile at evenly spread samples: along a side, every fourth of them, or every second one
/// where they are more than a pixel apart. What it misses is smaller than the blur, or a few
/// pixels.
class ViewSpread {
 public:
  /// @param samples  of the tile along a side
  /// @param apron    of these, on each side, not followed; 0: the samples are a pixel apart
  void begin(int samples, int apron);
  /// Follows the samples of another layer of the tile that are nearest to those of its first layer.
  void beginBehind(const ViewSpread& first, const TileLayer& first_layer, const TileLayer& layer);

  /// Follows no samples.
  void beginNone();

  /// The places that are followed.
  std::span<const std::size_t> places() const { return places_; }
  /// Room for what the next view sees there.
  std::span<SeenLight> next();

  /// The standard error of the mean of the views, at least two, if they were drawn at random:
  ///   sqrt(sum |J (v - m)|^2 / (n (n - 1))),
  /// with the n views v, their mean m in linear light, and the Jacobian J of L*a*b* at m.
  /// @param behind  by place
  /// @return by place
  std::array<float, SampledErrors::kMost> standardErrors(
      std::span<const BehindSample> behind) const;

  /// The mean transmittance of the views at a place.
  float transmittance(std::size_t place) const;

 private:
  void followSquare(int samples);
  std::size_t views() const { return seen_.size() / places_.size(); }

  std::vector<std::size_t> along_;  // samples along a side
  std::vector<std::size_t> places_;
  std::vector<SeenLight> seen_;  // of the views, one after the other
};

}  // namespace foci
