// Sums over a surfel's kernel and those of its neighbours, in SIMD lanes. Private to the weights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace foci {

/// A circular surfel, as the pairs read it.
struct PairSurfel {
  glm::vec3 position_m;
  float variance_m2;  ///< of its kernel along an axis, > 0
  glm::vec3 normal;   ///< unit length
  float weight_m2;    ///< >= 0
};

/// A surfel among its neighbours.
struct PairsOf {
  std::span<const PairSurfel> surfels;
  std::size_t surfel;
  glm::vec3 along;                      ///< unit length: kernels are seen along it, foreshortened
  std::span<const std::uint32_t> near;  ///< by distance, at most 64
  std::uint64_t sheet;                  ///< bit b: the b-th neighbour counts; no further bits
};

/// Sums over the surfel itself and the neighbours that count, with v = v_i + v_j for a pair. They
/// end where the neighbours are too far to add anything.
struct PairSums {
  float covered;      ///< sum_j w_j K, K the overlap of both kernels, dimensionless
  float slope_per_v;  ///< sum_j w_j dK/dv, 1/m^2; of Gaussians
  float variance_m2;  ///< sum_j v
  float pairs;        ///< that these are
  float own;          ///< K of the surfel with itself, 1/m^2
};

/// Neighbours are summed in blocks of so many.
inline constexpr std::size_t kPairBlock = 16;

/// K is the Gaussian of variance v, and dK/dv = K (d^2 / (2 v^2) - 1/v) at the distance d.
/// @param each  null, or gets K of each of the `pairs` - 1 neighbours, foreshortened, 1/m^2; has
///              place for those that count and for the rest of the last block
PairSums gaussianPairs(const PairsOf& pairs, float* each = nullptr);

/// K is the overlap of two rendered kernels (kernel_overlap.h).
/// @param prefilter_m2  added to the variance of each kernel, >= 0
PairSums renderedPairs(const PairsOf& pairs, float prefilter_m2, float* each = nullptr);

}  // namespace foci
