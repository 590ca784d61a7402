// The splats of a tile as a structure of arrays, from which each sub-aperture fills its batches,
// and the test which splats of a batch meet a block of samples. Included once a SIMD target.
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
#include <vector>

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

/// One sub-aperture: its centre in lens radii, and how far it sees a splat displaced for each
/// dioptre of defocus along the lens's nearest meridian and across that meridian.
struct SubApertureView {
  glm::vec2 centre;
  glm::vec2 px_per_D, across_px_per_D;
  /// Where directions have their own lens, splats have a matrix (`SubApertures::lens_px`) that
  /// displaces them by its product with the centre, and by this.
  glm::vec2 shift_px{0.0f};
};

/// A tile's splats, front to back. One object serves tile after tile, so it allocates seldom.
struct SubApertureSplats {
  enum Value {
    kX,
    kY,
    kExtentX,
    kExtentY,
    kOut,  ///< or the matrix's first row, in kAcross, too
    kAcross,
    kTiltX,
    kTiltY,
    kRow,  ///< the second row; with a matrix only
    kRowAcross,
    kValues
  };

  std::vector<Splat> splats;
  std::vector<float> values[kValues];  ///< by splat, in pixels and dioptres
  std::vector<std::size_t> ends;       ///< splat counts before each gap in depth, and the total
  bool by_matrix = false;

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

  /// After `set`.
  HWY_INLINE void setMatrix(std::size_t i, const glm::mat2& lens_px) {
    values[kOut][i] = lens_px[0][0];
    values[kAcross][i] = lens_px[1][0];
    values[kRow][i] = lens_px[0][1];
    values[kRowAcross][i] = lens_px[1][1];
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
      const auto seenAt = [&](Value v, Value out, Value across, float per_D, float across_per_D) {
        return hn::MulAdd(load(out), hn::Set(d, per_D),
                          hn::MulAdd(load(across), hn::Set(d, across_per_D), load(v)));
      };
      V x = seenAt(kX, kOut, kAcross, view.px_per_D.x, view.across_px_per_D.x);
      V y = seenAt(kY, by_matrix ? kRow : kOut, by_matrix ? kRowAcross : kAcross, view.px_per_D.y,
                   view.across_px_per_D.y);
      if (by_matrix) {
        x = hn::Add(x, hn::Set(d, view.shift_px.x));
        y = hn::Add(y, hn::Set(d, view.shift_px.y));
      }
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

#endif  // FOCI_BATCH_INL_H
