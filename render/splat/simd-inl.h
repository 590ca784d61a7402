// The SIMD types of the splat renderer. Included once a SIMD target.
#if defined(FOCI_SIMD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_SIMD_INL_H
#undef FOCI_SIMD_INL_H
#else
#define FOCI_SIMD_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_SIMD_INL_H
