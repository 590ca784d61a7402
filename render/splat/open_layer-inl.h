// The open layer of a few samples, while splats are added to it, and the point of the lens through
// which a sample sees a splat. Included once a SIMD target.
#if defined(FOCI_OPEN_LAYER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_OPEN_LAYER_INL_H
#undef FOCI_OPEN_LAYER_INL_H
#else
#define FOCI_OPEN_LAYER_INL_H
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "render/kernel/kernel.h"
#include "render/splat/layers-inl.h"
#include "render/splat/splat.h"
#include "render/splat/tile_job.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Lens radii, along the image's axes or the lens's meridians.
struct LensPoint {
  V x, y;
};

/// The mean lens point through which samples at (dx, dy) from a splat's centre see the splat.
template <bool kAstigmatic>
HWY_INLINE LensPoint lensPointAt(const TileJob& job, const SplatLens& lens, const SplatLens& across,
                                 V dx, V dy) {
  const D d;
  if constexpr (kAstigmatic) {
    const auto perPixel = [&](float x_of, float y_of) {
      return hn::MulAdd(dx, hn::Set(d, x_of), hn::Mul(dy, hn::Set(d, y_of)));
    };
    const glm::vec2 m = job.meridian * glm::vec2(job.lens_x, job.lens_y);
    const glm::vec2 a(-job.meridian.y * job.lens_x, job.meridian.x * job.lens_y);
    return {perPixel(lens.per_px * m.x, lens.per_px * m.y),
            perPixel(across.per_px * a.x, across.per_px * a.y)};
  } else {
    return {hn::Mul(dx, hn::Set(d, lens.per_px * job.lens_x)),
            hn::Mul(dy, hn::Set(d, lens.per_px * job.lens_y))};
  }
}

/// How much larger a slanted splat looks from a lens point (`SplatLens`).
template <bool kAstigmatic>
HWY_INLINE V tiltFactor(const TileJob& job, const SplatLens& lens, const LensPoint& point) {
  const D d;
  const glm::vec2 tilt(lens.tilt_x, lens.tilt_y), m = job.meridian;
  const V tilt_x = hn::Set(d, kAstigmatic ? glm::dot(tilt, m) : tilt.x);
  const V tilt_y = hn::Set(d, kAstigmatic ? tilt.y * m.x - tilt.x * m.y : tilt.y);
  return hn::Abs(hn::MulAdd(tilt_x, point.x, hn::MulAdd(tilt_y, point.y, hn::Set(d, 1.0f))));
}

/// Transmittance of the layers in front for a splat that is seen through a lens point, over their
/// mean transmittance. The step at the sample's edge (`findEdge`) is as soft as the splat's lens
/// points spread.
template <bool kAstigmatic>
HWY_INLINE V edgeTransmittance(const Light& light, std::size_t i, const LensPoint& point,
                               const SplatLens& lens, const SplatLens& across) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const V off = hn::NegMulAdd(
      hn::Load(d, light.edge_x + i), point.x,
      hn::NegMulAdd(hn::Load(d, light.edge_y + i), point.y, hn::Load(d, light.edge_at + i)));
  V sharpness = hn::Set(d, lens.inv_width);
  if constexpr (kAstigmatic) {
    // The variance along the edge's normal, whose components' squares sum to 1.
    const V width2 = hn::Set(d, 1.0f / (lens.inv_width * lens.inv_width));
    const V across_width2 = hn::Set(d, 1.0f / (across.inv_width * across.inv_width));
    const V n = hn::Load(d, light.edge_x + i);
    const V squared = hn::MulAdd(hn::Mul(n, n), hn::Sub(width2, across_width2), across_width2);
    sharpness = hn::Div(one, hn::Sqrt(squared));
  }
  const V within = hn::Min(hn::Max(hn::MulAdd(off, sharpness, hn::Set(d, 0.5f)), hn::Zero(d)), one);
  return hn::MulAdd(hn::Load(d, light.contrast + i), within, hn::Load(d, light.outside + i));
}

/// The open layer of a few samples, in registers: the sums of one side of the surface.
template <bool kTransparent, bool kDepth, bool kLens>
struct OpenLayer {
  V far_m, weight, red, green, blue, visible, distance, lens_weight, mean_x, mean_y;
  V blocked_x, blocked_y, right, above, right_above;

  HWY_INLINE void load(const Block& block, const Sums& sums, std::size_t i) {
    far_m = hn::Load(D(), block.far_m + i);
    forEachSum(*this, sums, [i](V& own, const float* sum) { own = hn::Load(D(), sum + i); });
  }

  HWY_INLINE void store(Block& block, Sums& sums, std::size_t i) const {
    hn::Store(far_m, D(), block.far_m + i);
    forEachSum(*this, sums, [i](const V& own, float* sum) { hn::Store(own, D(), sum + i); });
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
  /// Visits each sum that the layer has, here and in the block.
  template <class Layer, class BlockSums, class Visit>
  static HWY_INLINE void forEachSum(Layer& layer, BlockSums& sums, const Visit& visit) {
    visit(layer.weight, sums.weight);
    visit(layer.red, sums.red);
    visit(layer.green, sums.green);
    visit(layer.blue, sums.blue);
    if constexpr (kTransparent || kLens) visit(layer.visible, sums.visible);
    if constexpr (kDepth) visit(layer.distance, sums.distance);
    visit(layer.mean_x, sums.mean_x);
    visit(layer.mean_y, sums.mean_y);
    if constexpr (!kLens) return;
    visit(layer.lens_weight, sums.lens_weight);
    visit(layer.right, sums.right);
    visit(layer.above, sums.above);
    visit(layer.right_above, sums.right_above);
    visit(layer.blocked_x, sums.blocked_x);
    visit(layer.blocked_y, sums.blocked_y);
  }

  static HWY_INLINE V upToOpaque(V sum) {
    const D d;
    return hn::Max(hn::Sub(hn::Set(d, kOpaqueWeight), sum), hn::Zero(d));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_OPEN_LAYER_INL_H
