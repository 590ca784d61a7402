#include "render/normalisation/pair_sums.h"

#include <bit>
#include <cstring>
#include <numbers>

#include "render/normalisation/kernel_overlap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/normalisation/pair_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include <hwy/contrib/math/math-inl.h>

#ifndef FOCI_PAIR_SUMS_ONCE
#define FOCI_PAIR_SUMS_ONCE
namespace foci {

/// Cosine from which a kernel is not foreshortened: 1 % at most.
inline constexpr float kFacing = 0.995f;

/// Whatever the width of a vector: the order of the sums does not depend on it.
inline constexpr std::size_t kBlock = kPairBlock;

/// Where the Gaussians of a whole block have q above this, those of the further neighbours count
/// for nothing: each is below 6e-6 of its peak.
inline constexpr float kFarthest = 24.0f;

/// Some neighbours that count, in halves that vectors load. Surfels without weight fill the block.
struct Block {
  alignas(64) float place[4 * kBlock];   // position, variance
  alignas(64) float facing[4 * kBlock];  // normal, weight

  /// Takes neighbours off the front of `bits` and `near`.
  void take(const PairsOf& pairs, std::uint64_t& bits) {
    const PairSurfel* last = &pairs.surfels[pairs.surfel];
    for (std::size_t k = 0; k < kBlock; ++k) {
      const bool any = bits != 0;
      if (any) last = &pairs.surfels[pairs.near[static_cast<std::size_t>(std::countr_zero(bits))]];
      bits &= bits - 1;
      std::memcpy(place + 4 * k, &last->position_m, 4 * sizeof(float));
      std::memcpy(facing + 4 * k, &last->normal, 4 * sizeof(float));
      if (!any) facing[4 * k + 3] = 0.0f;
    }
  }
};

}  // namespace foci
#endif  // FOCI_PAIR_SUMS_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kBlock>;
using V = hn::Vec<D>;
constexpr std::size_t kVectors = kBlock / hn::MaxLanes(D());

struct Vec3 {
  V x, y, z;
};

HWY_INLINE V dot(const Vec3& a, const Vec3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

/// The surfel that all pairs have in common.
struct Own {
  Vec3 at, along, normal;
  V cosine, variance;
};

/// x' V^-1 x of the distance x of two kernels as the eye sees them, and |V|^-1/2, for the sum V of
/// their variances. The variance of a kernel on the plane across `along` is v (I - t t'), where t
/// is the normal's part on that plane.
struct Overlap {
  V q, per_area;   // the latter times the foreshortening of the neighbour's weight
  V variance;      // of the neighbour's kernel
  V sum, per_sum;  // of both variances, not foreshortened, and its inverse
  V weight;        // of the neighbour
};

HWY_INLINE Overlap overlapAt(const Block& block, std::size_t first, const Own& own, V prefilter) {
  const D d;
  Vec3 position, normal;
  V variance, weight;
  hn::LoadInterleaved4(d, block.place + 4 * first, position.x, position.y, position.z, variance);
  hn::LoadInterleaved4(d, block.facing + 4 * first, normal.x, normal.y, normal.z, weight);
  variance = hn::Add(variance, prefilter);
  const Vec3 apart{hn::Sub(position.x, own.at.x), hn::Sub(position.y, own.at.y),
                   hn::Sub(position.z, own.at.z)};
  const V one = hn::Set(d, 1.0f);
  const V sum = hn::Add(own.variance, variance);
  const V off_plane = dot(apart, own.along);
  const V x2 = hn::Max(hn::NegMulAdd(off_plane, off_plane, dot(apart, apart)), hn::Zero(d));
  const V cosine = dot(normal, own.along);
  const V size = hn::Abs(cosine);
  Overlap overlap;
  overlap.variance = variance;
  overlap.sum = hn::IfThenElseZero(hn::Gt(weight, hn::Zero(d)), sum);
  overlap.weight = weight;
  overlap.per_sum = hn::Div(one, sum);
  overlap.per_area = hn::Mul(size, overlap.per_sum);
  overlap.q = hn::Mul(x2, overlap.per_area);
  const hn::Mask<D> faces = hn::Gt(hn::Min(hn::Abs(own.cosine), size), hn::Set(d, kFacing));
  if (hn::AllTrue(d, faces)) return overlap;

  const V tilt_own = hn::NegMulAdd(own.cosine, own.cosine, one);
  const V tilt = hn::NegMulAdd(cosine, cosine, one);
  const V common = hn::NegMulAdd(own.cosine, cosine, dot(own.normal, normal));
  const V along_own = hn::NegMulAdd(own.cosine, off_plane, dot(own.normal, apart));
  const V along = hn::NegMulAdd(cosine, off_plane, dot(normal, apart));
  const V rest = hn::NegMulAdd(variance, tilt, hn::NegMulAdd(own.variance, tilt_own, sum));
  const V det =
      hn::MulAdd(hn::Mul(own.variance, variance),
                 hn::NegMulAdd(common, common, hn::Mul(tilt_own, tilt)), hn::Mul(sum, rest));
  const V q =
      hn::MulAdd(hn::Mul(variance, along), along,
                 hn::MulAdd(hn::Mul(own.variance, along_own), along_own, hn::Mul(rest, x2)));
  overlap.q = hn::IfThenElse(faces, overlap.q, hn::Div(q, det));
  overlap.per_area = hn::IfThenElse(faces, overlap.per_area, hn::Div(size, hn::Sqrt(det)));
  return overlap;
}

/// The sum over all lanes of a block.
HWY_INLINE float totalOf(const V (&vectors)[kVectors]) {
  const D d;
  alignas(64) float sums[kBlock];
  for (std::size_t k = 0; k < kVectors; ++k) hn::Store(vectors[k], d, sums + k * hn::Lanes(d));
  for (std::size_t half = kBlock / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) sums[k] += sums[k + half];
  }
  return sums[0];
}

/// Sums over all neighbours that count. `kernel(own, overlap, slope)` is the value of pairs and
/// sets their slope, both by weight; `far(q)` is where it counts for nothing.
/// @param each  the values, or null
template <class Kernel, class Far>
HWY_INLINE PairSums sumOf(const PairsOf& pairs, float prefilter_m2, float* each,
                          const Kernel& kernel, const Far& far) {
  const D d;
  const PairSurfel& surfel = pairs.surfels[pairs.surfel];
  const auto all = [&](const glm::vec3& v) HWY_ATTR {
    return Vec3{hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
  };
  const V prefilter = hn::Set(d, prefilter_m2);
  const Own own{all(surfel.position_m), all(pairs.along), all(surfel.normal),
                hn::Set(d, glm::dot(surfel.normal, pairs.along)),
                hn::Set(d, surfel.variance_m2 + prefilter_m2)};
  V covered[kVectors], slope[kVectors], variance[kVectors];
  for (std::size_t k = 0; k < kVectors; ++k) covered[k] = slope[k] = variance[k] = hn::Zero(d);
  int counted = 0;
  std::uint64_t bits = pairs.sheet;
  Block blocks[2];  // the next one is taken early: vectors wait for what was stored piece by piece
  if (bits != 0) blocks[0].take(pairs, bits);
  for (std::size_t b = 0; counted < std::popcount(pairs.sheet); ++b) {
    const int left = std::popcount(bits);
    if (left > 0) blocks[(b + 1) % 2].take(pairs, bits);
    counted = std::popcount(pairs.sheet) - left;
    bool ends = true;
    for (std::size_t k = 0; k < kVectors; ++k) {
      const Overlap overlap = overlapAt(blocks[b % 2], k * hn::Lanes(d), own, prefilter);
      V slope_of_pairs = hn::Zero(d);
      const V value = kernel(own, overlap, slope_of_pairs);
      if (each != nullptr) hn::StoreU(value, d, each + b * kBlock + k * hn::Lanes(d));
      covered[k] = hn::MulAdd(overlap.weight, value, covered[k]);
      slope[k] = hn::MulAdd(overlap.weight, slope_of_pairs, slope[k]);
      variance[k] = hn::Add(variance[k], overlap.sum);
      ends = ends && hn::AllTrue(d, far(overlap.q));
    }
    if (ends) break;
  }
  return {totalOf(covered), totalOf(slope), totalOf(variance), static_cast<float>(counted), 0.0f};
}

}  // namespace

PairSums sumGaussianPairs(const PairsOf& pairs, float* each) {
  const D d;
  constexpr float kPerCircle = 0.5f * std::numbers::inv_pi_v<float>;
  return sumOf(
      pairs, 0.0f, each,
      [&](const Own&, const Overlap& overlap, V& slope) HWY_ATTR {
        const V half_q = hn::Mul(hn::Set(d, 0.5f), overlap.q);
        const V kernel =
            hn::Mul(hn::Mul(hn::Set(d, kPerCircle), overlap.per_area), hn::Exp(d, hn::Neg(half_q)));
        slope = hn::Mul(kernel, hn::Mul(hn::Sub(half_q, hn::Set(d, 1.0f)), overlap.per_sum));
        return kernel;
      },
      [&](V q) HWY_ATTR { return hn::Gt(q, hn::Set(d, kFarthest)); });
}

PairSums sumRenderedPairs(const PairsOf& pairs, float prefilter_m2, float* each) {
  const D d;
  const hn::RebindToSigned<D> di;
  const KernelOverlap& table = KernelOverlap::table();
  return sumOf(
      pairs, prefilter_m2, each,
      [&](const Own& own, const Overlap& overlap, V&) HWY_ATTR {
        const V other = overlap.variance;
        const V ratio =
            hn::Sqrt(hn::Div(hn::Min(own.variance, other), hn::Max(own.variance, other)));
        const V q = hn::Mul(overlap.q, hn::Set(d, 1.0f / 16.0f));
        const hn::Mask<D> meet = hn::Lt(q, hn::Set(d, 1.0f));
        // The place between four values of the table.
        const V across = hn::IfThenElseZero(meet, hn::Mul(q, hn::Set(d, KernelOverlap::kSteps)));
        const V down = hn::Max(hn::Mul(hn::Sub(ratio, hn::Set(d, KernelOverlap::kMinRatio)),
                                       hn::Set(d, KernelOverlap::kRatiosPerUnit)),
                               hn::Zero(d));
        const auto column = hn::ConvertTo(di, across);
        const auto row = hn::Min(hn::ConvertTo(di, down), hn::Set(di, KernelOverlap::kRatios - 1));
        const V t = hn::Sub(across, hn::ConvertTo(d, column));
        const V s = hn::Sub(down, hn::ConvertTo(d, row));
        const auto at = hn::Add(hn::Mul(row, hn::Set(di, KernelOverlap::kColumns)), column);
        const float* values = table.values();
        const auto along_row = [&](const float* first) HWY_ATTR {
          const V left = hn::GatherIndex(d, first, at), right = hn::GatherIndex(d, first + 1, at);
          return hn::MulAdd(t, hn::Sub(right, left), left);
        };
        const V low = along_row(values), high = along_row(values + KernelOverlap::kColumns);
        const V kernel = hn::MulAdd(s, hn::Sub(high, low), low);
        return hn::IfThenElseZero(meet, hn::Mul(overlap.per_area, kernel));
      },
      [&](V q) HWY_ATTR { return hn::Ge(q, hn::Set(d, 16.0f)); });
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(sumGaussianPairs);
HWY_EXPORT(sumRenderedPairs);

namespace {

/// The pair of the surfel with itself, in closed form: its foreshortening cancels.
PairSums withItself(const PairSurfel& surfel, float prefilter_m2, float peak) {
  const float sum = 2.0f * (surfel.variance_m2 + prefilter_m2);
  const float own = peak / sum, kernel = surfel.weight_m2 * own;
  return {kernel, -kernel / sum, sum, 1.0f, own};
}

PairSums total(const PairSums& a, const PairSums& b) {
  return {a.covered + b.covered, a.slope_per_v + b.slope_per_v, a.variance_m2 + b.variance_m2,
          a.pairs + b.pairs, a.own + b.own};
}

}  // namespace

PairSums gaussianPairs(const PairsOf& pairs, float* each) {
  constexpr float kPeak = 0.5f * std::numbers::inv_pi_v<float>;
  return total(withItself(pairs.surfels[pairs.surfel], 0.0f, kPeak),
               HWY_DYNAMIC_DISPATCH(sumGaussianPairs)(pairs, each));
}

PairSums renderedPairs(const PairsOf& pairs, float prefilter_m2, float* each) {
  constexpr float kPeak = 0.45f * std::numbers::inv_pi_v<float>;  // int K_v(x)^2 dx, times 2 v
  return total(withItself(pairs.surfels[pairs.surfel], prefilter_m2, kPeak),
               HWY_DYNAMIC_DISPATCH(sumRenderedPairs)(pairs, prefilter_m2, each));
}

}  // namespace foci
#endif  // HWY_ONCE
