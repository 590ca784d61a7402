// How far away Gaussians are, sample by sample. Included once a SIMD target.
#if defined(FOCI_VERGENCES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_VERGENCES_INL_H
#undef FOCI_VERGENCES_INL_H
#else
#define FOCI_VERGENCES_INL_H
#endif

#include <cstddef>

#include "render/gaussians/composite.h"
#include "render/splat/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Mean vergences of Gaussians, one lane each, given the place: at the offset d from the centre,
///   1/U + d' V_p^-1 (s - e a)      (projected.h),
/// within the bounds that kVergenceReach standard deviations of the vergence, or of the distance,
/// set.
struct alignas(64) Vergences {
  static constexpr std::size_t kMost = TileGaussians::kBlock;
  float at[kMost], slope_x[kMost], slope_y[kMost], low[kMost], high[kMost];

  /// @param e  variance of the vergence
  HWY_INLINE void see(V distance_m, V e, V by_x, V by_y) {
    const D d;
    const V middle = hn::Div(hn::Set(d, 1.0f), distance_m);
    const V highest = hn::MulAdd(hn::Set(d, kVergenceReach), hn::Sqrt(e), middle);
    hn::Store(middle, d, at);
    hn::Store(by_x, d, slope_x);
    hn::Store(by_y, d, slope_y);
    hn::Store(hn::Div(hn::Mul(middle, middle), highest), d, low);
    hn::Store(highest, d, high);
  }

  /// Of lane `k`.
  HWY_INLINE V ofSamples(std::size_t k, V dx, V dy) const {
    const D d;
    const auto lane = [&](const float* of) { return hn::Set(d, of[k]); };
    const V mean = hn::MulAdd(lane(slope_x), dx, hn::MulAdd(lane(slope_y), dy, lane(at)));
    return hn::Clamp(mean, lane(low), lane(high));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_VERGENCES_INL_H
