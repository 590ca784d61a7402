// How far the views of a tile through sub-apertures lie apart. `auto` judges the error of their
// mean by it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/gaussians/tile_layers.h"

namespace foci {

/// Errors at the samples that are followed, in just-noticeable differences.
struct SampledErrors {
  static constexpr std::size_t kMost = 256;
  /// By layer of the tile; those behind the first as far as they show.
  std::array<std::array<float, kMost>, TileLayers::kMost> layers_jnd{};
  std::size_t count = 0;
};

/// The polynomials of degree one and two in the discs' centres, orthonormal over the discs and to
/// the constant: as many as the discs distinguish, at most five. By polynomial, then disc.
std::vector<std::vector<float>> polynomialsOver(std::span<const LensDisc> discs);

/// Of the views at a sample, in just-noticeable differences from their mean.
struct SpreadSquares {
  float all = 0.0f;   ///< sum of squares
  float rest = 0.0f;  ///< the same without what is polynomial
};

/// The error of the mean of views (`ViewSpread::errorsOfMean`), by sample.
/// @param discs        at least three (asserted)
/// @param polynomials  that they distinguish
std::array<float, SampledErrors::kMost> errorsOfMean(std::span<const SpreadSquares> samples,
                                                     std::size_t discs, std::size_t polynomials,
                                                     float radius_px);

/// The error of one view: 1.1 times its distance from the mean of its judges, the views of the same
/// samples through three discs. On tiles of two captures with blur of up to 9 px, the error is 0.8
/// to 1.07 of the distance. The garden (0.9 to 1.05) and scattered Gaussians (0.6 to 0.9) took no
/// part.
/// @param distance_jnd  in just-noticeable differences
inline float errorOfOne(float distance_jnd) { return 1.1f * distance_jnd; }

/// What lies behind a sample, the same for all views.
struct BehindSample {
  glm::vec3 display{0.0f};  ///< display value
  glm::vec3 light{0.0f};    ///< mean linear light, less that of the display value
};

/// Samples along a side of a tile that are followed.
struct FollowedAlong {
  int first = 0, apart = 1, count = 0;
};

/// Evenly spread samples: every fourth of them, or every second one where they are more than a
/// pixel apart. What they miss is smaller than the blur, or a few pixels.
/// @param samples  of the tile along a side
/// @param apron    of these, on each side, not followed; 0: the samples are a pixel apart
FollowedAlong followedAlong(int samples, int apron);

/// Follows a tile at the samples of `followedAlong`.
class ViewSpread {
 public:
  void begin(int samples, int apron);
  /// Follows the samples of another layer of the tile that are nearest to those of its first layer.
  void beginBehind(const ViewSpread& first, const TileLayer& first_layer, const TileLayer& layer);

  /// Follows the samples of `other` in a tile that has no others.
  /// @return the first of them along a side of the tile, and the number from one to the next
  std::pair<std::size_t, std::size_t> beginBeside(const ViewSpread& other);

  /// Follows no samples.
  void beginNone();

  int along() const { return static_cast<int>(along_.size()); }  ///< samples along a side

  /// The places that are followed.
  std::span<const std::size_t> places() const { return places_; }
  /// Room for what the next view sees there.
  std::span<SeenLight> next();

  /// The error of the mean of the views, at least three, by place. Discs integrate exactly what
  /// varies over the lens as a polynomial of degree two (lens_samples.h), so that this part of the
  /// views' spread is no error. With the rest R, as a standard error, all of the spread S, over the
  /// tile, and the blur radius r, n discs err by about
  ///   1.4 r / (r + 4 px) R (R / S)^1.5 min((n / 19)^-0.18, 1):
  /// the smoother the views vary, the faster higher degrees fall off. Three views leave no rest.
  /// Their error is about 1.2 S r^2 / (r^2 + (4 px)^2): S grows with r, what is left of third
  /// degree with r^3.
  ///
  /// Edges anywhere on the lens err by 1.05 to 1.15 times this, with seven discs and with 127; with
  /// three by 0.4 (tests of ViewSpread). The exponents and the shares by radius are fits to tiles
  /// of two captures, which agree; the garden (builtin/garden.cpp) and scattered Gaussians took no
  /// part. docs/results.md has the errors of whole frames over their predictions.
  /// @param discs      of the views, in their order
  /// @param radius_px  blur radius of what the views show
  /// @param behind     by place
  std::array<float, SampledErrors::kMost> errorsOfMean(std::span<const LensDisc> discs,
                                                       float radius_px,
                                                       std::span<const BehindSample> behind) const;

  /// The error of one view (`errorOfOne`), by place.
  /// @param judges  the views of the same samples through three discs
  std::array<float, SampledErrors::kMost> errorsOfOne(const ViewSpread& judges,
                                                      std::span<const BehindSample> behind) const;

  /// The mean transmittance of the views at a place.
  float transmittance(std::size_t place) const;

 private:
  void followSquare(int samples);
  std::size_t views() const { return seen_.size() / places_.size(); }
  glm::vec3 lightOf(std::size_t view, std::size_t place, const BehindSample& behind) const;

  std::vector<std::size_t> along_;  // samples along a side
  std::vector<std::size_t> places_;
  std::vector<SeenLight> seen_;  // of the views, one after the other
};

}  // namespace foci
