#include "render/gaussians/composite.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/gaussians/composite.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After foreach_target.h:
#include "render/gaussians/composite_tile-inl.h"

#if HWY_ONCE
namespace foci {

HWY_EXPORT(compositeTileLanes);

std::size_t compositeTile(const CompositeJob& job, TileSums& sums) {
  return HWY_DYNAMIC_DISPATCH(compositeTileLanes)(job, sums);
}

}  // namespace foci
#endif  // HWY_ONCE
