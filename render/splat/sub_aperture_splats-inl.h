// The splats of a tile as a structure of arrays, from which each sub-aperture fills its batches.
// Included once a SIMD target.
#if defined(FOCI_SUB_APERTURE_SPLATS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_SUB_APERTURE_SPLATS_INL_H
#undef FOCI_SUB_APERTURE_SPLATS_INL_H
#else
#define FOCI_SUB_APERTURE_SPLATS_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/splat/batch-inl.h"
#include "render/splat/splat.h"

#ifndef FOCI_SUB_APERTURE_SPLATS_ONCE
#define FOCI_SUB_APERTURE_SPLATS_ONCE
namespace foci {

/// One sub-aperture: its centre in lens radii, and how far it sees a splat displaced for each
/// dioptre of defocus along the lens's nearest meridian and across that meridian.
struct SubApertureView {
  glm::vec2 centre;
  glm::vec2 px_per_D, across_px_per_D;
};

}  // namespace foci
#endif  // FOCI_SUB_APERTURE_SPLATS_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// A tile's splats, front to back. One object serves tile after tile, so it allocates seldom.
struct SubApertureSplats {
  enum Value { kX, kY, kExtentX, kExtentY, kOut, kAcross, kTiltX, kTiltY, kValues };

  std::vector<Splat> splats;
  std::vector<float> values[kValues];  ///< by splat, in pixels and dioptres
  std::vector<std::size_t> ends;       ///< splat counts before each gap in depth, and the total

  /// Makes room for `count` splats, and for a SIMD step that reads past the last one.
  void reset(std::size_t count) {
    splats.resize(count);
    ends.clear();
    for (auto& of_splats : values) of_splats.resize(count + hn::Lanes(D()));
  }

  HWY_INLINE void set(std::size_t i, const Splat& splat, float out_of_focus_D, float out_across_D,
                      const SplatLens& lens) {
    splats[i] = splat;
    values[kX][i] = splat.x_px;
    values[kY][i] = splat.y_px;
    values[kExtentX][i] = splat.extent_x_px;
    values[kExtentY][i] = splat.extent_y_px;
    values[kOut][i] = out_of_focus_D;
    values[kAcross][i] = out_across_D;
    values[kTiltX][i] = lens.tilt_x;
    values[kTiltY][i] = lens.tilt_y;
  }

  /// Puts the splats of [begin, end) that meet the samples from `first_px` to `last_px` into the
  /// batch. Stops when the batch has no room for another SIMD step.
  /// @return the index to continue from; `end` when all are done
  HWY_INLINE std::size_t put(std::size_t begin, std::size_t end, const SubApertureView& view,
                             const glm::vec2& first_px, const glm::vec2& last_px,
                             Batch& batch) const {
    const D d;
    const std::size_t step = hn::Lanes(d);
    const V one = hn::Set(d, 1.0f);
    std::size_t at = begin;
    for (; at < end && batch.count + step <= Batch::kCapacity; at += step) {
      const std::size_t some = std::min(step, end - at);
      const auto load = [&](Value v) { return hn::LoadU(d, values[v].data() + at); };
      const V out = load(kOut), across = load(kAcross);
      const auto seenAt = [&](Value v, float per_D, float across_per_D) {
        return hn::MulAdd(out, hn::Set(d, per_D),
                          hn::MulAdd(across, hn::Set(d, across_per_D), load(v)));
      };
      const V x = seenAt(kX, view.px_per_D.x, view.across_px_per_D.x);
      const V y = seenAt(kY, view.px_per_D.y, view.across_px_per_D.y);
      const V extent_x = load(kExtentX), extent_y = load(kExtentY);
      const V left = hn::Sub(x, extent_x), right = hn::Add(x, extent_x);
      const V top = hn::Sub(y, extent_y), bottom = hn::Add(y, extent_y);
      const M beside =
          hn::Or(hn::Gt(left, hn::Set(d, last_px.x)), hn::Lt(right, hn::Set(d, first_px.x)));
      const M above =
          hn::Or(hn::Gt(top, hn::Set(d, last_px.y)), hn::Lt(bottom, hn::Set(d, first_px.y)));
      const M meets = hn::AndNot(hn::Or(beside, above), hn::FirstN(d, some));
      const V size = hn::Abs(hn::MulAdd(load(kTiltX), hn::Set(d, view.centre.x),
                                        hn::MulAdd(load(kTiltY), hn::Set(d, view.centre.y), one)));
      const unsigned n = batch.count;
      hn::StoreU(hn::Compress(x, meets), d, batch.x_px + n);
      hn::StoreU(hn::Compress(y, meets), d, batch.y_px + n);
      hn::StoreU(hn::Compress(size, meets), d, batch.size + n);
      const V inv_radius = hn::Div(one, hn::Min(extent_x, extent_y));
      hn::StoreU(hn::Compress(inv_radius, meets), d, batch.inv_radius + n);
      hn::StoreU(hn::Compress(left, meets), d, batch.left_px + n);
      hn::StoreU(hn::Compress(right, meets), d, batch.right_px + n);
      hn::StoreU(hn::Compress(top, meets), d, batch.top_px + n);
      hn::StoreU(hn::Compress(bottom, meets), d, batch.bottom_px + n);
      const hn::RebindToUnsigned<D> u;
      const auto index = hn::Iota(u, static_cast<std::uint32_t>(at));
      hn::StoreU(hn::Compress(index, hn::RebindMask(u, meets)), u, batch.splat + n);
      batch.count += static_cast<unsigned>(hn::CountTrue(d, meets));
    }
    return std::min(at, end);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_SUB_APERTURE_SPLATS_INL_H
