// The open layer of a few samples, while splats are added to it. Included once a SIMD target.
#if defined(FOCI_OPEN_LAYER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_OPEN_LAYER_INL_H
#undef FOCI_OPEN_LAYER_INL_H
#else
#define FOCI_OPEN_LAYER_INL_H
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>

#include "render/kernel/limits.h"
#include "render/splat/layers-inl.h"
#include "render/splat/splat.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// The open layer of a few samples, in registers: the sums of one side of the surface.
template <bool kTransparent, bool kDepth, bool kLens>
struct OpenLayer {
  V far_m, weight, red, green, blue, visible, distance, lens_weight, mean_x, mean_y;
  V blocked_x, blocked_y, right, above, right_above;

  HWY_INLINE void load(const Block& block, const Sums& sums, std::size_t i) {
    const D d;
    far_m = hn::Load(d, block.far_m + i);
    weight = hn::Load(d, sums.weight + i);
    red = hn::Load(d, sums.red + i);
    green = hn::Load(d, sums.green + i);
    blue = hn::Load(d, sums.blue + i);
    if constexpr (kTransparent || kLens) visible = hn::Load(d, sums.visible + i);
    if constexpr (kDepth) distance = hn::Load(d, sums.distance + i);
    mean_x = hn::Load(d, sums.mean_x + i);
    mean_y = hn::Load(d, sums.mean_y + i);
    if constexpr (kLens) {
      lens_weight = hn::Load(d, sums.lens_weight + i);
      right = hn::Load(d, sums.right + i);
      above = hn::Load(d, sums.above + i);
      right_above = hn::Load(d, sums.right_above + i);
      blocked_x = hn::Load(d, sums.blocked_x + i);
      blocked_y = hn::Load(d, sums.blocked_y + i);
    }
  }

  HWY_INLINE void store(Block& block, Sums& sums, std::size_t i) const {
    const D d;
    hn::Store(far_m, d, block.far_m + i);
    hn::Store(weight, d, sums.weight + i);
    hn::Store(red, d, sums.red + i);
    hn::Store(green, d, sums.green + i);
    hn::Store(blue, d, sums.blue + i);
    if constexpr (kTransparent || kLens) hn::Store(visible, d, sums.visible + i);
    if constexpr (kDepth) hn::Store(distance, d, sums.distance + i);
    hn::Store(mean_x, d, sums.mean_x + i);
    hn::Store(mean_y, d, sums.mean_y + i);
    if constexpr (kLens) {
      hn::Store(lens_weight, d, sums.lens_weight + i);
      hn::Store(right, d, sums.right + i);
      hn::Store(above, d, sums.above + i);
      hn::Store(right_above, d, sums.right_above + i);
      hn::Store(blocked_x, d, sums.blocked_x + i);
      hn::Store(blocked_y, d, sums.blocked_y + i);
    }
  }

  /// Adds a splat's colours.
  /// @param seen  its weight, times the share of the light that reaches it
  HWY_INLINE void addColour(const Splat& splat, V seen) {
    const D d;
    if constexpr (kTransparent || kLens) {
      visible = hn::MulAdd(seen, hn::Set(d, std::abs(splat.opacity)), visible);
    }
    red = hn::MulAdd(seen, hn::Set(d, splat.red), red);
    green = hn::MulAdd(seen, hn::Set(d, splat.green), green);
    blue = hn::MulAdd(seen, hn::Set(d, splat.blue), blue);
    if constexpr (kDepth) {
      const float opaque_m = 0.5f * (splat.near_m + splat.far_m) * std::abs(splat.opacity);
      distance = hn::MulAdd(seen, hn::Set(d, opaque_m), distance);
    }
  }

  /// Adds a splat's weight by the lens points that see it.
  /// @param point  their mean
  /// @param inv_width_x, inv_width_y  of `SplatLens`, along both axes
  HWY_INLINE void addLensPoints(V all, const LensPoint& point, float inv_width_x,
                                float inv_width_y) {
    const D d;
    const auto positive = [&](V mean, float inv_width) {  // share of a uniform distribution
      const V share = hn::MulAdd(mean, hn::Set(d, inv_width), hn::Set(d, 0.5f));
      return hn::Min(hn::Max(share, hn::Zero(d)), hn::Set(d, 1.0f));
    };
    const V on_right = hn::Mul(all, positive(point.x, inv_width_x));
    const V upper = positive(point.y, inv_width_y);
    lens_weight = hn::Add(lens_weight, all);
    mean_x = hn::MulAdd(all, point.x, mean_x);
    mean_y = hn::MulAdd(all, point.y, mean_y);
    right = hn::Add(right, on_right);
    above = hn::MulAdd(all, upper, above);
    right_above = hn::MulAdd(on_right, upper, right_above);
  }

  /// Adds the light that a splat blocks, by the lens point that sees it.
  /// @param seen  its weight, times the share of the light that reaches it
  HWY_INLINE void addBlocked(const Splat& splat, V seen, const LensPoint& point) {
    const V blocked = kTransparent ? hn::Mul(seen, hn::Set(D(), std::abs(splat.opacity))) : seen;
    blocked_x = hn::MulAdd(blocked, point.x, blocked_x);
    blocked_y = hn::MulAdd(blocked, point.y, blocked_y);
  }

  /// The part of `all` that the layer takes before it is opaque.
  HWY_INLINE V taken(V all) const { return hn::Min(all, upToOpaque(weight)); }

  /// The part of `all` that is seen. Behind an edge on the lens, a layer's first splats may be
  /// hidden and its later ones in view, so that the layer takes splats until those in view make it
  /// opaque. (Where `visible` holds opacities, their weights decide.)
  /// @param reaching  share of the light that reaches the splat
  HWY_INLINE V seen(V all, V reaching) const {
    if constexpr (kLens && !kTransparent) {
      return hn::Min(hn::Mul(all, reaching), upToOpaque(visible));
    }
    return hn::Mul(taken(all), reaching);
  }

 private:
  static HWY_INLINE V upToOpaque(V sum) {
    const D d;
    return hn::Max(hn::Sub(hn::Set(d, kOpaqueWeight), sum), hn::Zero(d));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_OPEN_LAYER_INL_H
