// The lens as each splat's direction sees it (render/optics/lens_field.h), one SIMD step at a time.
// Included once a SIMD target.
#if defined(FOCI_FIELD_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_FIELD_LANES_INL_H
#undef FOCI_FIELD_LANES_INL_H
#else
#define FOCI_FIELD_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "render/kernel/simd-inl.h"
#include "render/optics/lens_field.h"
#include "render/splat/constants.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// `LensField::at`, one place in each lane.
struct LocalLanes {
  static constexpr std::size_t kCapacity = 16;
  alignas(64) float values[LocalLens::kPadding][kCapacity];

  HWY_INLINE V operator[](LocalLens::Value i) const { return hn::Load(D(), values[i]); }
};

/// @param x_px, y_px  from the principal point
HWY_INLINE void localLenses(const LensField& field, V x_px, V y_px, LocalLanes& out) {
  const D d;
  const float per_step = 1.0f / field.step_px();
  const auto placeOf = [&](V px, float first_px, int size) {
    const V place = hn::Mul(hn::Sub(px, hn::Set(d, first_px)), hn::Set(d, per_step));
    // Also for values that are not finite.
    return hn::Min(hn::Max(place, hn::Zero(d)), hn::Set(d, static_cast<float>(size - 1)));
  };
  const auto nodeAt = [&](float x, float y) {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(field.size().x);
    return &field.nodes()[row + static_cast<std::size_t>(x)];
  };
  const V px = placeOf(x_px, field.first_px().x, field.size().x);
  const V py = placeOf(y_px, field.first_px().y, field.size().y);
  const V left = hn::Min(hn::Floor(px), hn::Set(d, static_cast<float>(field.size().x - 2)));
  const V above = hn::Min(hn::Floor(py), hn::Set(d, static_cast<float>(field.size().y - 2)));
  const V share_x = hn::Sub(px, left), share_y = hn::Sub(py, above);

  alignas(64) float lefts[LocalLanes::kCapacity], aboves[LocalLanes::kCapacity];
  hn::Store(left, d, lefts);
  hn::Store(above, d, aboves);

  // Neighbours in memory are neighbours on the image, so most lanes lie between the same nodes.
  auto rest = hn::FirstN(d, hn::Lanes(d));
  for (bool first = true; !hn::AllFalse(d, rest); first = false) {
    const auto k = static_cast<std::size_t>(hn::FindFirstTrue(d, rest));
    const LocalLens* top = nodeAt(lefts[k], aboves[k]);
    const LocalLens* bottom = top + field.size().x;
    const auto here =
        hn::And(hn::Eq(left, hn::Set(d, lefts[k])), hn::Eq(above, hn::Set(d, aboves[k])));
    for (std::size_t i = 0; i < LocalLens::kPadding; ++i) {
      const auto along = [&](const LocalLens* row) {
        const float from = row[0].values[i];
        return hn::MulAdd(share_x, hn::Set(d, row[1].values[i] - from), hn::Set(d, from));
      };
      const V upper = along(top);
      const V value = hn::MulAdd(share_y, hn::Sub(along(bottom), upper), upper);
      float* to = out.values[i];
      hn::Store(first ? value : hn::IfThenElse(here, value, hn::Load(d, to)), d, to);
    }
    rest = hn::AndNot(here, rest);
  }
}

/// A 2x2 matrix in each lane.
struct Matrix2 {
  V xx, xy, yx, yy;
};
HWY_INLINE Matrix2 product(const Matrix2& a, const Matrix2& b) {
  return {hn::MulAdd(a.xx, b.xx, hn::Mul(a.xy, b.yx)), hn::MulAdd(a.xx, b.xy, hn::Mul(a.xy, b.yy)),
          hn::MulAdd(a.yx, b.xx, hn::Mul(a.yy, b.yx)), hn::MulAdd(a.yx, b.xy, hn::Mul(a.yy, b.yy))};
}

/// A part of the lens as its direction sees it: `LocalLens` at a part's centre c and radius a.
struct PartLens {
  Matrix2 blur_px;   ///< displacement of points of the part, over their place in it times 1/a
  Matrix2 per_D_px;  ///< P S: how `blur_px` changes with the focus
  V shift_x_px, shift_y_px;
  /// Of the traceless part of the blur of a point in focus: (xx - yy) and (xy + yx).
  V apart_px, aside_px;
};

/// @param off_D  focus less vergence, without astigmatism
/// @param j      (J0, J45)
/// @param local  values by `LocalLens::Value`
template <class Local>
HWY_INLINE PartLens partLens(const Local& local, V off_D, const glm::vec2& j,
                             const glm::vec2& centre, float radius) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const Matrix2 p{local[LocalLens::kPxx], local[LocalLens::kPxy], local[LocalLens::kPyx],
                  local[LocalLens::kPyy]};
  const V sxy = local[LocalLens::kSxy];
  const Matrix2 s{local[LocalLens::kSxx], sxy, sxy, local[LocalLens::kSyy]};
  V fxx = hn::Add(local[LocalLens::kFxx], set(j.x)),
    fxy = hn::Add(local[LocalLens::kFxy], set(j.y));
  V fyy = hn::Sub(local[LocalLens::kFyy], set(j.x));
  PartLens lens;
  lens.per_D_px = product(p, s);
  lens.shift_x_px = lens.shift_y_px = hn::Zero(d);
  if (centre.x != 0.0f || centre.y != 0.0f || radius < 1.0f) {
    const V ux = hn::MulAdd(s.xx, set(centre.x), hn::Mul(s.xy, set(centre.y)));
    const V uy = hn::MulAdd(s.yx, set(centre.x), hn::Mul(s.yy, set(centre.y)));
    const V cx = local[LocalLens::kComaX], cy = local[LocalLens::kComaY];
    // A u of coma, for both rows: q is u'(A u), and its gradient twice A u.
    const V both = hn::MulAdd(cy, ux, hn::Mul(cx, uy));
    const V xx = hn::MulAdd(hn::Mul(set(3.0f), cx), ux, hn::Mul(cy, uy));
    const V yy = hn::MulAdd(hn::Mul(set(3.0f), cy), uy, hn::Mul(cx, ux));
    // The mean of u'A u over the disc, less that over the part: a share of tr(S A S) / 4.
    const V ss_xx = hn::MulAdd(s.xx, s.xx, hn::Mul(sxy, sxy));
    const V ss_yy = hn::MulAdd(s.yy, s.yy, hn::Mul(sxy, sxy));
    const V ss_xy = hn::Mul(sxy, hn::Add(s.xx, s.yy));
    const V share = set(0.25f * (1.0f - radius * radius));
    const V twice = hn::Add(ss_xy, ss_xy);
    const V mean_x = hn::MulAdd(cx, hn::MulAdd(set(3.0f), ss_xx, ss_yy), hn::Mul(cy, twice));
    const V mean_y = hn::MulAdd(cy, hn::MulAdd(set(3.0f), ss_yy, ss_xx), hn::Mul(cx, twice));
    const V dx = hn::MulAdd(hn::Add(off_D, hn::Add(fxx, xx)), ux,
                            hn::MulAdd(hn::Add(fxy, both), uy, hn::Neg(hn::Mul(share, mean_x))));
    const V dy = hn::MulAdd(
        hn::Add(fxy, both), ux,
        hn::MulAdd(hn::Add(off_D, hn::Add(fyy, yy)), uy, hn::Neg(hn::Mul(share, mean_y))));
    lens.shift_x_px = hn::MulAdd(p.xx, dx, hn::Mul(p.xy, dy));
    lens.shift_y_px = hn::MulAdd(p.yx, dx, hn::Mul(p.yy, dy));
    const V slope = set(2.0f * std::sqrt(std::max(1.0f - kComaOverlap * radius * radius, 0.0f)));
    fxx = hn::MulAdd(slope, xx, fxx);
    fxy = hn::MulAdd(slope, both, fxy);
    fyy = hn::MulAdd(slope, yy, fyy);
  }
  const Matrix2 in_focus = product(p, product({fxx, fxy, fxy, fyy}, s));
  lens.apart_px = hn::Sub(in_focus.xx, in_focus.yy);
  lens.aside_px = hn::Add(in_focus.xy, in_focus.yx);
  lens.blur_px = {hn::MulAdd(off_D, lens.per_D_px.xx, in_focus.xx),
                  hn::MulAdd(off_D, lens.per_D_px.xy, in_focus.xy),
                  hn::MulAdd(off_D, lens.per_D_px.yx, in_focus.yx),
                  hn::MulAdd(off_D, lens.per_D_px.yy, in_focus.yy)};
  return lens;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_FIELD_LANES_INL_H
