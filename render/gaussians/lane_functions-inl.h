// Powers of one half, linear light and the vergences of Gaussians, by lane. Included once a SIMD
// target.
#if defined(FOCI_LANE_FUNCTIONS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_LANE_FUNCTIONS_INL_H
#undef FOCI_LANE_FUNCTIONS_INL_H
#else
#define FOCI_LANE_FUNCTIONS_INL_H
#endif

#include <cstddef>

#include "render/gaussians/composite.h"
#include "render/kernel/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// 2^-q for -100 <= q <= 100, to 4e-6 of its value: the polynomial through 5 Chebyshev nodes for
/// the fraction, and the exponent's bits.
HWY_INLINE V powerOfHalf(V q) {
  const D d;
  const hn::RebindToSigned<D> di;
  const V x = hn::Neg(q);
  const V whole = hn::Floor(x);
  const V f = hn::Sub(x, whole);
  V p = hn::MulAdd(hn::Set(d, 0.0136703095f), f, hn::Set(d, 0.0517449978f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.2416043573f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.6929729222f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0000034929f));
  const auto exponent = hn::ShiftLeft<23>(hn::ConvertTo(di, whole));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), exponent));
}

/// Linear light of an sRGB value from 0 to 1 (IEC 61966-2-1), to 1e-5: the polynomial through 7
/// Chebyshev nodes for the power.
HWY_INLINE V linearOf(V s) {
  const D d;
  V p = hn::MulAdd(hn::Set(d, -0.0471605818f), s, hn::Set(d, 0.2031365960f));
  p = hn::MulAdd(p, s, hn::Set(d, -0.4062709499f));
  p = hn::MulAdd(p, s, hn::Set(d, 0.7008707547f));
  p = hn::MulAdd(p, s, hn::Set(d, 0.5158576898f));
  p = hn::MulAdd(p, s, hn::Set(d, 0.0326325297f));
  p = hn::MulAdd(p, s, hn::Set(d, 0.0009311454f));
  return hn::IfThenElse(hn::Le(s, hn::Set(d, 0.04045f)), hn::Mul(s, hn::Set(d, 1.0f / 12.92f)), p);
}

/// Linear light of a display value, clamped to 0 and 1.
HWY_INLINE V lightOf(V display) {
  const D d;
  return linearOf(hn::Min(hn::Max(display, hn::Zero(d)), hn::Set(d, 1.0f)));
}

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

#endif  // FOCI_LANE_FUNCTIONS_INL_H
