// Composites the Gaussians of a tile front to back, as one sub-aperture sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gaussians/projected.h"
#include "render/optics/lens_field.h"
#include "render/splat/bin.h"

namespace foci {

/// Places of a tile's samples: rows of squares of kSquare x kSquare places, so that one SIMD vector
/// holds most of a small footprint. Places beyond the last sample of a row or column are unused.
inline constexpr std::size_t kSquare = 4, kSquarePlaces = kSquare * kSquare;
constexpr std::size_t squaresOf(int samples) {  ///< along a side
  return (static_cast<std::size_t>(samples) + kSquare - 1) / kSquare;
}
constexpr std::size_t placesOf(int samples) {
  return squaresOf(samples) * squaresOf(samples) * kSquarePlaces;
}
/// @param x, y  of the sample
constexpr std::size_t placeOf(int samples, std::size_t x, std::size_t y) {
  return (y / kSquare * squaresOf(samples) + x / kSquare) * kSquarePlaces + y % kSquare * kSquare +
         x % kSquare;
}
inline constexpr std::size_t kTilePlaces = placesOf(kMostSamples);

/// A tile's share of the frame: sums over sub-apertures.
struct TileSums {
  alignas(64) float red[kTilePlaces], green[kTilePlaces], blue[kTilePlaces];  ///< linear light
  alignas(64) float coverage[kTilePlaces], distance_m[kTilePlaces];  ///< distance times coverage
};

/// What lies behind Gaussians: the mean over views through the lens near one sub-aperture. Planes
/// of places.
struct BehindPlanes {
  enum Plane : std::size_t {
    red,  ///< mean display values
    green,
    blue,
    /// Mean linear light; where it is used, less the linear light of the mean display values.
    light_red,
    light_green,
    light_blue,
    coverage,
    distance_m,  ///< times coverage
    kPlanes
  };
  alignas(64) float planes[kPlanes][kTilePlaces];
};

/// A disc within the lens, in lens radii.
struct LensDisc {
  glm::vec2 centre{0.0f};
  float radius = 0.0f;
};

/// Bounds of the discs.
std::vector<SubApertureSize> subApertureSizes(const std::vector<LensDisc>& discs);

/// A tile's Gaussians, front to back, as far as any sub-aperture has needed them. In blocks of
/// kBlock entries: each of the numbers below is kBlock floats.
class TileGaussians {
 public:
  static constexpr std::size_t kBlock = 16;
  enum Number : std::size_t {
    x_px,
    y_px,
    vxx,
    vxy,
    vyy,
    sx,
    sy,
    e,
    off_D,
    opacity,
    cut,
    red,
    green,
    blue,
    distance_m,
    kNumbers
  };

  /// @param list  of the tile; both outlive the tile
  /// @param field  of the lens; null: one lens for all directions
  void begin(const ProjectedGaussian* gaussians, std::span<const std::uint32_t> list,
             const LensField* field = nullptr, const glm::vec2& principal_px = glm::vec2(0.0f));
  std::size_t size() const { return list_.size(); }

  /// Fetches the entries up to `end`, which are at most all.
  void fetch(std::size_t end) {
    while (fetched_ < end) fetchBlock();
  }
  /// A number of the fetched entries from `at` on, within a block.
  const float* at(Number number, std::size_t at) const {
    return values_.data() + (at / kBlock * kNumbers + number) * kBlock + at % kBlock;
  }

  /// The lens in the direction of each fetched entry, by value (`LocalLens`), kBlock floats each.
  const float* lensesAt(std::size_t at) const {
    return lenses_.data() + at / kBlock * kBlock * LocalLens::kValues + at % kBlock;
  }

 private:
  void fetchBlock();

  const ProjectedGaussian* gaussians_ = nullptr;
  std::span<const std::uint32_t> list_;
  const LensField* field_ = nullptr;
  glm::vec2 principal_px_{0.0f};
  std::vector<float> values_, lenses_;
  std::size_t fetched_ = 0;  // a multiple of kBlock
};

struct CompositeJob {
  TileGaussians* gaussians = nullptr;
  const Defocus* defocus = nullptr;
  glm::vec2 principal_px{0.0f};  ///< of the view, for `Defocus::field`
  glm::vec2 first_px{0.0f};      ///< the first sample
  float step_px = 1.0f;          ///< from sample to sample
  int samples = kTile;           ///< along a side, aprons included
  LensDisc lens;
  glm::vec3 background{0.0f};  ///< display values
  /// What lies behind instead of the background, at the same samples. Called where it shows.
  std::function<const BehindPlanes&()> behind;
  bool depth = false;
};

/// Light on its way to the lens: of a tile's Gaussians in display values, and the transmittance.
using SeenLight = glm::vec4;

/// Composites in display values, as scenes are trained, and adds the result to the sums in linear
/// light. Display values are clamped to 0 and 1 first. Over what lies behind, of mean display
/// values d and mean linear light l, Gaussians of value c and transmittance t show
///   f(c + t d) + t^2 (l - f(d)),   f: linear light of a display value.
/// This is exact for t = 0, for c = 0 and t = 1, and if f were a parabola.
/// @param followed  places
/// @param seen      what is seen of the Gaussians at these places
/// @return the number of samples inside of the Gaussians' footprints
std::size_t compositeTile(const CompositeJob& job, TileSums& sums,
                          std::span<const std::size_t> followed, std::span<SeenLight> seen);

/// Composites in the same way, and keeps nothing but what is seen.
std::size_t seeTile(const CompositeJob& job, std::span<const std::size_t> followed,
                    std::span<SeenLight> seen);

/// Composites in the same way, and adds display values and linear light to each of `views`, times
/// its weight.
std::size_t compositeBehind(const CompositeJob& job, std::span<const float> weights,
                            std::span<BehindPlanes> views, std::span<const std::size_t> followed,
                            std::span<SeenLight> seen);

/// Samples along a side, from edge to edge of a square, and where the samples that are interpolated
/// from them lie: the first, and the distance between them, in units of the former.
struct Resampling {
  int from_samples = 0, to_samples = 0;
  float first = 0.0f, step = 1.0f;
};

/// Subtracts the linear light of the display values from the light of `from`, and interpolates it.
void interpolateBehind(const Resampling& resampling, BehindPlanes& from, BehindPlanes& to);

}  // namespace foci
