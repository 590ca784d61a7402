// A tile's Gaussians in layers: the more blurred ones behind the focus need few samples and many
// views, those before them many samples and few views.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/gaussians/projected.h"
#include "render/splat/bin.h"

namespace foci {

/// How blurred Gaussians of a tile are.
struct TileBlur {
  /// Their blur radius: the mean of their fourth powers, weighted by opacity, so that few blurred
  /// ones count more than many sharp ones, and a single faint one does not.
  float radius_px = 0.0f;
  bool everywhere = false;  ///< nothing is sharp: the samples are more than a pixel apart
};

/// The error of the mean of n views of an edge falls as n to this power (a fit from 3 to 91).
inline constexpr float kErrorOrder = -0.8f;

/// The error of 95 % of the pixels of a captured scene, in just-noticeable differences, by the blur
/// radius alone: 0.5 a pixel for one disc, 0.9 where nothing is sharp. It bounds the error of a
/// single disc, which has no spread of views, and is a first guess for others: colours that
/// differ more than those of captures err more.
float errorByBlur(int discs, const TileBlur& blur);

struct TileLayer {
  std::size_t size = 0;  ///< Gaussians
  int step_px = 1;       ///< from sample to sample
  int samples = 0;       ///< along a side: those of the tile; of others, from edge to edge
  TileBlur blur = {};
};

/// Front to back, as the tile's list is. The first has the tile's samples.
struct TileLayers {
  static constexpr std::size_t kMost = 3;
  std::array<TileLayer, kMost> layers;
  std::size_t count = 1;

  std::span<const TileLayer> all() const { return {layers.data(), count}; }
};

/// Several layers where they take clearly less time than one, and the samples are a pixel apart.
/// All layers but the first lie behind the last Gaussian that needs finer samples, or is nearer
/// than the focus.
/// @param list     of the tile: indices, front to back
/// @param size_px  of the frame
TileLayers layersOf(const Tile& tile, std::span<const std::uint32_t> list,
                    const ProjectedGaussians& projected, const glm::ivec2& size_px);

/// What dividing a tile needs of a Gaussian.
struct ListedGaussian {
  float blur_px = 0.0f;
  float opacity = 0.0f;
  int step_px = 1;  ///< largest distance of samples; 1 nearer than the focus
};

/// The same from the tile's list itself.
TileLayers layersOf(const Tile& tile, std::span<const ListedGaussian> list,
                    const glm::ivec2& size_px);

TileLayers oneLayer(const Tile& tile, std::size_t size);
TileBlur blurOf(const Tile& tile, std::span<const std::uint32_t> list,
                const ProjectedGaussians& projected);

}  // namespace foci
