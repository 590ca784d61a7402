// Powers of one half and linear light, one a lane. Included once a SIMD target.
#if defined(FOCI_LANE_FUNCTIONS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_LANE_FUNCTIONS_INL_H
#undef FOCI_LANE_FUNCTIONS_INL_H
#else
#define FOCI_LANE_FUNCTIONS_INL_H
#endif

#include "render/splat/simd-inl.h"

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

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_LANE_FUNCTIONS_INL_H
