// Splats of a tile, a batch at a time, and which of them meet which of its blocks. Included once a
// SIMD target.
#if defined(FOCI_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_BATCH_INL_H
#undef FOCI_BATCH_INL_H
#else
#define FOCI_BATCH_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

#include "render/splat/layers-inl.h"
#include "render/splat/splat.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Splats as they come, front to back: where their centres are and how large they look, seen from
/// where they are seen from, and their footprints' boxes.
struct Batch {
  static constexpr unsigned kMost = 64;
  unsigned count = 0;
  alignas(64) std::uint32_t splat[kMost] = {};
  alignas(64) float x_px[kMost] = {}, y_px[kMost] = {};
  alignas(64) float size[kMost] = {};  // their weights count that many times, from parts of a lens
  alignas(64) float left_px[kMost] = {}, right_px[kMost] = {};
  alignas(64) float top_px[kMost] = {}, bottom_px[kMost] = {};

  /// Adds a splat as it lies. There must be room.
  HWY_INLINE void put(const Splat& added, std::uint32_t index) {
    const unsigned n = count++;
    splat[n] = index;
    x_px[n] = added.x_px;
    y_px[n] = added.y_px;
    left_px[n] = x_px[n] - added.extent_x_px;
    right_px[n] = x_px[n] + added.extent_x_px;
    top_px[n] = y_px[n] - added.extent_y_px;
    bottom_px[n] = y_px[n] + added.extent_y_px;
  }

  /// Those, a bit each, whose spans [low, high] meet [from_px, to_px].
  HWY_INLINE std::uint64_t meeting(const float* low, const float* high, float from_px,
                                   float to_px) const {
    const D d;
    const V from = hn::Set(d, from_px), to = hn::Set(d, to_px);
    std::uint64_t all = 0;
    for (std::size_t n = 0; n < kMost; n += hn::Lanes(d)) {
      const M meets =
          hn::And(hn::Ge(hn::Load(d, high + n), from), hn::Le(hn::Load(d, low + n), to));
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, meets, bytes);
      std::uint64_t bits = 0;
      std::memcpy(&bits, bytes, sizeof bits);
      all |= bits << n;
    }
    return count < kMost ? all & ((std::uint64_t{1} << count) - 1) : all;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_BATCH_INL_H
