// The point of the lens through which a sample sees a splat, and the effects of that point: the
// size of a slanted splat, and the light that layers in front block. Included once a SIMD target.
#if defined(FOCI_LENS_POINT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_LENS_POINT_INL_H
#undef FOCI_LENS_POINT_INL_H
#else
#define FOCI_LENS_POINT_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <glm/glm.hpp>

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

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_LENS_POINT_INL_H
