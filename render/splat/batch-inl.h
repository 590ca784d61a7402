// A batch of a tile's splats, and the test which of them meet a block of samples. Included once a
// SIMD target.
#if defined(FOCI_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_BATCH_INL_H
#undef FOCI_BATCH_INL_H
#else
#define FOCI_BATCH_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

#include "render/splat/layers-inl.h"
#include "render/splat/splat.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Up to kCapacity splats, front to back, with their centres and the boxes of their footprints as
/// the current sub-aperture (or the whole aperture) sees them.
struct Batch {
  static constexpr unsigned kCapacity = 64;
  unsigned count = 0;
  alignas(64) std::uint32_t splat[kCapacity] = {};
  alignas(64) float x_px[kCapacity] = {}, y_px[kCapacity] = {};
  alignas(64) float size[kCapacity] = {};  // factor on the weights; set for sub-apertures only
  alignas(64) float inv_radius[kCapacity] = {};  // of the footprint across its narrower side, 1/px
  alignas(64) float left_px[kCapacity] = {}, right_px[kCapacity] = {};
  alignas(64) float top_px[kCapacity] = {}, bottom_px[kCapacity] = {};

  /// Adds a splat as the whole aperture sees it. The batch must have room.
  HWY_INLINE void put(const Splat& added, std::uint32_t index) {
    const unsigned n = count++;
    splat[n] = index;
    x_px[n] = added.x_px;
    y_px[n] = added.y_px;
    left_px[n] = x_px[n] - added.extent_x_px;
    right_px[n] = x_px[n] + added.extent_x_px;
    top_px[n] = y_px[n] - added.extent_y_px;
    bottom_px[n] = y_px[n] + added.extent_y_px;
    inv_radius[n] = 1.0f / std::min(added.extent_x_px, added.extent_y_px);
  }

  /// One bit for each splat: whether its span [low, high] meets [from_px, to_px].
  HWY_INLINE std::uint64_t meeting(const float* low, const float* high, float from_px,
                                   float to_px) const {
    const D d;
    const V from = hn::Set(d, from_px), to = hn::Set(d, to_px);
    std::uint64_t all = 0;
    for (std::size_t n = 0; n < kCapacity; n += hn::Lanes(d)) {
      const M meets =
          hn::And(hn::Ge(hn::Load(d, high + n), from), hn::Le(hn::Load(d, low + n), to));
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, meets, bytes);
      std::uint64_t bits = 0;
      std::memcpy(&bits, bytes, sizeof bits);
      all |= bits << n;
    }
    return count < kCapacity ? all & ((std::uint64_t{1} << count) - 1) : all;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_BATCH_INL_H
