// Projects surfels and nodes of the level-of-detail tree to the image, one SIMD step at a time:
// their places, variances and blur. Included once a SIMD target.
#if defined(FOCI_PROJECT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_PROJECT_LANES_INL_H
#undef FOCI_PROJECT_LANES_INL_H
#else
#define FOCI_PROJECT_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/kernel/kernel.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/lens_field.h"
#include "render/splat/constants.h"
#include "render/splat/field_lanes-inl.h"
#include "render/splat/footprint-inl.h"

#ifndef FOCI_PROJECT_LANES_ONCE
#define FOCI_PROJECT_LANES_ONCE
namespace foci {

/// Parameters of a projection.
struct ProjectJob {
  glm::mat3 rows;                    // the axes of the eye: right, up, back
  glm::vec3 eye;                     // in the world, metres
  glm::vec2 focal, principal, size;  // pixels
  float near_m;
  float margin;    // `Projection::margin_px`
  glm::vec2 blur;  // blur radius of the aperture, pixels a dioptre
  float focus_D;
  glm::vec2 j;         // `Defocus::astigmatism_D`
  float astigmatism;   // its length
  glm::vec2 lens;      // displacement for the aperture's centre, pixels a dioptre
  float sub_aperture;  // `Projection::sub_aperture`
  Acuity acuity;
  bool along_axis, gaussian, oriented;
  Lighting lighting;
  const KernelShape* shapes;    // `kernelShapes()`
  const std::uint8_t* outside;  // `bodiesFromOutside`; null: there are no bodies
  float lens_m;                 // `lensRadius_m`
  float lens_px_per_D;          // blur radius of the whole lens
  const LensField* field;       // `shownField`; then `lens` is 0
  glm::vec2 centre;             // of the aperture, lens radii
  float aperture;               // its radius over the lens's
};

inline bool blurs(const ProjectJob& job) { return job.blur.x > 0.0f && job.blur.y > 0.0f; }

}  // namespace foci
#endif  // FOCI_PROJECT_LANES_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
HWY_INLINE V3 rowOf(const ProjectJob& job, int r) {
  const D d;
  return {hn::Set(d, job.rows[r].x), hn::Set(d, job.rows[r].y), hn::Set(d, job.rows[r].z)};
}

/// How lens points follow from offsets on the image, along one meridian.
struct LensScales {
  alignas(64) float per_px[16] = {};     // lens radii a px
  alignas(64) float inv_width[16] = {};  // of the lens points that see one offset, 1 / lens radii
};

/// The results of one SIMD step, which scalar code reads one lane after the other.
struct ProjectedLanes {
  static constexpr std::size_t kCapacity = 16;
  alignas(64) float x[kCapacity], y[kCapacity];
  alignas(64) float vxx[kCapacity], vxy[kCapacity], vyy[kCapacity];  // unblurred variance, px^2
  alignas(64) float prefilter[kCapacity];  // the prefilter's share of that variance
  alignas(64) float blur_x2[kCapacity], blur_y2[kCapacity];  // variance of the blur
  alignas(64) float blur_xy[kCapacity] = {};                 // 0 unless the lens is astigmatic
  alignas(64) float blur_min2[kCapacity];                    // along the meridian of the least blur
  alignas(64) float radius[kCapacity];                       // largest blur radius; with a field,
                                                             // root of both axes' mean square
  alignas(64) float narrow[kCapacity];             // unblurred variance over squared blur radius
  alignas(64) float added[kCapacity];              // variance that merging added, of one axis
  alignas(64) float defocus_D[kCapacity];          // without astigmatism
  alignas(64) float out_of_focus_D[kCapacity];     // along the nearest meridian
  alignas(64) float out_across_D[kCapacity] = {};  // across it; astigmatic lens only
  LensScales lens, lens_across;  // of a lens that blurs; across: astigmatic lens only
  alignas(64) float lens_px[4][kCapacity] = {};  // `PartLens::blur_px` by rows; with a field only
  alignas(64) float tilt_x[kCapacity], tilt_y[kCapacity];  // see `SplatLens`
  alignas(64) float area_px[kCapacity];
  alignas(64) float distance[kCapacity], reach[kCapacity];
  alignas(64) float shade[kCapacity];
  alignas(64) float away[kCapacity];      // cosine of the normal to the sight; > 0: back-facing
  alignas(64) float behind_m[kCapacity];  // how far the eye lies behind the surfel's plane
  alignas(64) float visible[kCapacity];   // 1: keep
};

/// Variance of the blur along x and y, and the unblurred variance over the squared blur radius,
/// which sets the kernel's exponent (`kernelExponent`).
struct BlurVariance {
  V x2, y2, narrow;
};

/// A splat's variance, the prefilter included, and the variance of its blur, px^2.
struct BlurredVariance {
  V sharp_xx, sharp_xy, sharp_yy, blur_xx, blur_xy, blur_yy;
};

/// Surfels and merged nodes smear a sheet. The smear widens an outline as a larger lens would, so
/// it counts as part of the lens: two outlines that meet then still meet. The prefilter differs
/// from the lens point at random, as does a smear beyond the width of the blur.
/// @param variance  of the unblurred splat, px^2, its prefilter included
/// @param off_D     of that sign are the offsets
HWY_INLINE void storeLensScales(V radius_px, V variance, V prefilter, V off_D, LensScales& out) {
  const D d;
  const V k = hn::Set(d, kDiscVariancePerRadius2);
  const V blur = hn::Mul(hn::Mul(k, radius_px), radius_px);
  const V smear = hn::Min(hn::Max(hn::Sub(variance, prefilter), hn::Zero(d)), blur);
  const V lens = hn::Add(blur, smear), random = hn::Sub(variance, smear);
  const V all = hn::Add(lens, random);
  hn::Store(hn::CopySign(hn::Div(hn::Sqrt(hn::Mul(k, lens)), all), off_D), d, out.per_px);
  const V least = hn::Mul(hn::Set(d, 3.0f), hn::Max(random, hn::Set(d, 1e-12f)));
  hn::Store(hn::Sqrt(hn::Div(all, least)), d, out.inv_width);
}

/// The lens's points along its nearest meridian and across.
/// @param v  without blur
HWY_INLINE void storeMeridians(const ProjectJob& job, const BlurredVariance& v, V prefilter,
                               V off_D, V across_D, ProjectedLanes& out) {
  const D d;
  const V det = hn::NegMulAdd(v.sharp_xy, v.sharp_xy, hn::Mul(v.sharp_xx, v.sharp_yy));
  const V unblurred = hn::Sqrt(hn::Max(det, hn::Zero(d)));
  const V radius = hn::Set(d, std::sqrt(job.blur.x * job.blur.y));
  storeLensScales(hn::Mul(radius, off_D), unblurred, prefilter, off_D, out.lens);
  storeLensScales(hn::Mul(radius, across_D), unblurred, prefilter, across_D, out.lens_across);
  hn::Store(off_D, d, out.out_of_focus_D);
  hn::Store(across_D, d, out.out_across_D);
}

/// Unblurred variance over the squared blur radius, for an ellipse of confusion.
///
/// Let f1 >= f2 be the blur's shares of W along its principal axes. The kernel with the mean fourth
/// moment of ellipse and Gaussian (of q, over W) is the kernel of a disc with the share f:
///
///   f^2 = (3 f1^2 + 3 f2^2 + 2 f1 f2) / 8.
///
/// For a disc f = f1 = f2. The formula gives a line a bell that is longer than the line, so
/// kLongAxis of f^2 is f1^2.
HWY_INLINE V narrowOfEllipse(float k, const BlurredVariance& v) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  // f1 + f2 = tr(W^-1 B), f1 f2 = |B| / |W|, with B the blur's variance.
  const V bxx = v.blur_xx, bxy = v.blur_xy, byy = v.blur_yy;
  const V wxx = hn::Add(v.sharp_xx, bxx), wxy = hn::Add(v.sharp_xy, bxy);
  const V wyy = hn::Add(v.sharp_yy, byy);
  const V inv_det = hn::Div(set(1.0f), hn::NegMulAdd(wxy, wxy, hn::Mul(wxx, wyy)));
  const V sum = hn::Mul(
      inv_det, hn::NegMulAdd(hn::Add(wxy, wxy), bxy, hn::MulAdd(wyy, bxx, hn::Mul(wxx, byy))));
  const V product = hn::Mul(inv_det, hn::NegMulAdd(bxy, bxy, hn::Mul(bxx, byy)));
  const V moment2 = hn::MulAdd(hn::Mul(set(0.375f), sum), sum, hn::Mul(set(-0.5f), product));
  const V apart2 = hn::MulAdd(sum, sum, hn::Mul(set(-4.0f), product));
  const V longer = hn::Mul(set(0.5f), hn::Add(sum, hn::Sqrt(hn::Max(apart2, hn::Zero(d)))));
  const V share2 =
      hn::MulAdd(hn::Mul(set(kLongAxis), longer), longer, hn::Mul(set(1.0f - kLongAxis), moment2));
  const V share = hn::Sqrt(hn::Max(share2, set(1e-12f)));
  // Of a disc, share = k / (k + narrow).
  const V narrow = hn::Mul(set(k), hn::Sub(hn::Div(set(1.0f), share), set(1.0f)));
  return hn::Max(narrow, hn::Zero(d));
}

/// The ellipse of confusion of an astigmatic lens: blur of variance k B B', B = diag(r) (F - I/U),
/// on splats of variance `sharp`, prefilter included.
HWY_INLINE BlurVariance blurEllipse(const ProjectJob& job, V out_of_focus_D, V sharp_xx, V sharp_xy,
                                    V sharp_yy, V prefilter, ProjectedLanes& out) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const float k = job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2;
  const V j45 = set(job.j.y), astigmatism = set(job.astigmatism);
  const V fx = hn::Add(out_of_focus_D, set(job.j.x)), fy = hn::Sub(out_of_focus_D, set(job.j.x));
  const V bxx = hn::Mul(set(k * job.blur.x * job.blur.x), hn::MulAdd(fx, fx, hn::Mul(j45, j45)));
  const V byy = hn::Mul(set(k * job.blur.y * job.blur.y), hn::MulAdd(fy, fy, hn::Mul(j45, j45)));
  const V bxy = hn::Mul(set(2.0f * k * job.blur.x * job.blur.y * job.j.y), out_of_focus_D);

  const V mean_D = hn::Abs(out_of_focus_D), min_D = hn::Sub(mean_D, astigmatism);
  const float narrowest = std::min(job.blur.x, job.blur.y);
  const float radius = std::sqrt(job.blur.x * job.blur.y);
  hn::Store(bxy, d, out.blur_xy);
  hn::Store(hn::Mul(set(k * narrowest * narrowest), hn::Mul(min_D, min_D)), d, out.blur_min2);
  hn::Store(hn::Mul(set(radius), hn::Add(mean_D, astigmatism)), d, out.radius);
  const BlurredVariance v{sharp_xx, sharp_xy, sharp_yy, bxx, bxy, byy};
  storeMeridians(job, v, prefilter, hn::Add(out_of_focus_D, astigmatism),
                 hn::Sub(out_of_focus_D, astigmatism), out);
  return {bxx, byy, narrowOfEllipse(k, v)};
}

/// The ellipse of confusion where each direction has its own lens: the variance k a^2 B B' of its
/// linear part, and that of coma, a^4 C.
HWY_INLINE BlurVariance blurOfField(const ProjectJob& job, const PartLens& lens,
                                    const LocalLanes& local, V sharp_xx, V sharp_xy, V sharp_yy,
                                    V prefilter, ProjectedLanes& out) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const float k = job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2;
  const float a2 = job.aperture * job.aperture;
  const V linear = set(k * a2), coma = set(a2 * a2);
  const Matrix2& b = lens.blur_px;
  const auto variance = [&](V ax, V ay, V bx, V by, LocalLens::Value c) {
    return hn::MulAdd(linear, hn::MulAdd(ax, bx, hn::Mul(ay, by)), hn::Mul(coma, local[c]));
  };
  const V bxx = variance(b.xx, b.xy, b.xx, b.xy, LocalLens::kCxx);
  const V bxy = variance(b.xx, b.xy, b.yx, b.yy, LocalLens::kCxy);
  const V byy = variance(b.yx, b.yy, b.yx, b.yy, LocalLens::kCyy);
  const V half = set(0.5f), zero = hn::Zero(d);
  const V middle = hn::Mul(half, hn::Add(bxx, byy)), off = hn::Mul(half, hn::Sub(bxx, byy));
  const V apart = hn::Sqrt(hn::MulAdd(off, off, hn::Mul(bxy, bxy)));
  hn::Store(bxy, d, out.blur_xy);
  hn::Store(hn::Max(hn::Sub(middle, apart), zero), d, out.blur_min2);
  hn::Store(hn::Sqrt(hn::Mul(set(1.0f / k), middle)), d, out.radius);

  // B along the meridian of the nearest focus (`LensField::meridianAt`), and across.
  const float mean = std::sqrt(job.blur.x * job.blur.y);
  const V per_D = set(mean > 0.0f ? 0.5f * job.aperture / mean : 0.0f);
  const V length =
      hn::Sqrt(hn::MulAdd(lens.apart_px, lens.apart_px, hn::Mul(lens.aside_px, lens.aside_px)));
  const V inv = hn::Div(set(1.0f), hn::Max(length, set(1e-12f)));
  const V along = hn::Mul(inv, hn::MulAdd(hn::Sub(b.xx, b.yy), lens.apart_px,
                                          hn::Mul(hn::Add(b.xy, b.yx), lens.aside_px)));
  const V trace = hn::Add(b.xx, b.yy);
  const BlurredVariance v{sharp_xx, sharp_xy, sharp_yy, bxx, bxy, byy};
  storeMeridians(job, v, prefilter, hn::Mul(per_D, hn::Add(trace, along)),
                 hn::Mul(per_D, hn::Sub(trace, along)), out);
  hn::Store(b.xx, d, out.lens_px[0]);
  hn::Store(b.xy, d, out.lens_px[1]);
  hn::Store(b.yx, d, out.lens_px[2]);
  hn::Store(b.yy, d, out.lens_px[3]);
  return {bxx, byy, narrowOfEllipse(k, v)};
}

/// The centres of a step's surfels or nodes, as the aperture's centre sees them.
struct Centres {
  V3 p;                    // from the eye, in the world's directions, metres
  V x_px, y_px;            // on the image
  V axis_x_px, axis_y_px;  // of the view's axis, as the aperture's centre sees it
  V inv_depth;             // 1 / depth along the axis
  V inv_sight;             // 1 / distance along the line of sight
  V distance;              // along the line of sight or the axis
  V out_of_focus_D;        // focus_D - 1/U
  hn::Mask<D> too_near;    // nearer than job.near_m
  Gradients to;
};

/// Projects centres by perspective, with the Jacobian at each:
///   x = c_x + f_x X / d,  y = c_y - f_y Y / d,  d = -Z.
/// @param local, lens  output; set with a field only
template <class Source>
HWY_INLINE Centres projectCentres(const ProjectJob& job, const Source& source, std::size_t i,
                                  LocalLanes& local, PartLens& lens) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V3 right = rowOf(job, 0), up = rowOf(job, 1), back = rowOf(job, 2);
  Centres c;
  V3 p = positionOf(source, i);
  p = {hn::Sub(p.x, set(job.eye[0])), hn::Sub(p.y, set(job.eye[1])), hn::Sub(p.z, set(job.eye[2]))};
  c.p = p;
  const V depth = hn::Neg(dot(back, p));
  c.too_near = hn::Lt(depth, set(job.near_m));
  const V inv_depth = hn::Div(one, hn::Max(depth, set(job.near_m)));
  c.inv_depth = inv_depth;
  const V tx = hn::Mul(dot(right, p), inv_depth), ty = hn::Mul(dot(up, p), inv_depth);
  const V sx = hn::Mul(set(job.focal.x), inv_depth), sy = hn::Mul(set(-job.focal.y), inv_depth);

  // Distance along the line of sight or along the axis.
  const V sight2 = dot(p, p);
  c.inv_sight = hn::Div(one, hn::Sqrt(sight2));
  c.distance = job.along_axis ? depth : hn::Mul(sight2, c.inv_sight);
  const V inv_distance = job.along_axis ? hn::Div(one, c.distance) : c.inv_sight;

  // From the aperture's centre the image moves with the vergence, and so does the Jacobian.
  c.out_of_focus_D = hn::Sub(set(job.focus_D), inv_distance);
  c.axis_x_px = hn::MulAdd(set(job.lens.x), c.out_of_focus_D, set(job.principal.x));
  c.axis_y_px = hn::MulAdd(set(job.lens.y), c.out_of_focus_D, set(job.principal.y));
  c.x_px = hn::MulAdd(set(job.focal.x), tx, c.axis_x_px);
  c.y_px = hn::NegMulAdd(set(job.focal.y), ty, c.axis_y_px);
  const V slope = hn::Mul(inv_distance, inv_distance);
  V slope_x = hn::Mul(set(job.lens.x), slope), slope_y = hn::Mul(set(job.lens.y), slope);
  if (job.field) {
    localLenses(*job.field, hn::Mul(set(job.focal.x), tx), hn::Mul(set(-job.focal.y), ty), local);
    lens = partLens(local, c.out_of_focus_D, job.j, job.centre, job.aperture);
    c.axis_x_px = hn::Add(c.axis_x_px, lens.shift_x_px);
    c.axis_y_px = hn::Add(c.axis_y_px, lens.shift_y_px);
    c.x_px = hn::Add(c.x_px, lens.shift_x_px);
    c.y_px = hn::Add(c.y_px, lens.shift_y_px);
    const Matrix2& per_D = lens.per_D_px;
    const V x = set(job.centre.x), y = set(job.centre.y);
    slope_x = hn::Mul(slope, hn::MulAdd(per_D.xx, x, hn::Mul(per_D.xy, y)));
    slope_y = hn::Mul(slope, hn::MulAdd(per_D.yx, x, hn::Mul(per_D.yy, y)));
  }
  const auto gradients = [&](V p_axis, V right_axis, V up_axis, V back_axis, V& x, V& y, V& along) {
    along = job.along_axis ? hn::Neg(back_axis) : hn::Mul(p_axis, c.inv_sight);
    x = hn::MulAdd(slope_x, along, hn::Mul(sx, hn::MulAdd(back_axis, tx, right_axis)));
    y = hn::MulAdd(slope_y, along, hn::Mul(sy, hn::MulAdd(back_axis, ty, up_axis)));
  };
  gradients(p.x, right.x, up.x, back.x, c.to.x.x, c.to.y.x, c.to.distance.x);
  gradients(p.y, right.y, up.y, back.y, c.to.x.y, c.to.y.y, c.to.distance.y);
  gradients(p.z, right.z, up.z, back.z, c.to.x.z, c.to.y.z, c.to.distance.z);
  return c;
}

/// Variance of the prefilter: as wide as the observer's acuity at that distance from the gaze.
HWY_INLINE V prefilterAt(const ProjectJob& job, V x_px, V y_px) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V gaze_dx = hn::Sub(x_px, set(job.acuity.gaze_px.x)),
          gaze_dy = hn::Sub(y_px, set(job.acuity.gaze_px.y));
  const V from_gaze = hn::Sqrt(hn::MulAdd(gaze_dx, gaze_dx, hn::Mul(gaze_dy, gaze_dy)));
  const V finest =
      hn::Max(hn::MulAdd(set(job.acuity.per_px), from_gaze, set(job.acuity.base_px)), set(1.0f));
  return hn::Mul(finest, finest);
}

/// Blur by the circle of confusion (Eq. 4 in dioptres), or by the ellipse of an astigmatic lens.
HWY_INLINE BlurVariance blurOf(const ProjectJob& job, const Footprint& f, V out_of_focus_D,
                               V prefilter, const LocalLanes& local, const PartLens& lens,
                               ProjectedLanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V defocus_D = hn::Abs(out_of_focus_D);
  const V cx = hn::Mul(set(job.blur.x), defocus_D), cy = hn::Mul(set(job.blur.y), defocus_D);
  const V per_radius2 = set(job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2);
  const V x2 = hn::Mul(hn::Mul(per_radius2, cx), cx);
  const V y2 = hn::Mul(hn::Mul(per_radius2, cy), cy);
  // A node's kernel has edges soft enough that neighbouring nodes still sum to one.
  const V soft = hn::MulAdd(hn::Set(d, kOverlap - 1.0f), hn::Sub(one, f.own), one);
  if (job.field) {
    return blurOfField(job, lens, local, hn::MulAdd(soft, f.vxx, prefilter), hn::Mul(soft, f.vxy),
                       hn::MulAdd(soft, f.vyy, prefilter), prefilter, out);
  }
  if (job.astigmatism != 0.0f) {
    return blurEllipse(job, out_of_focus_D, hn::MulAdd(soft, f.vxx, prefilter),
                       hn::Mul(soft, f.vxy), hn::MulAdd(soft, f.vyy, prefilter), prefilter, out);
  }
  const V soft2 = hn::Mul(soft, soft);
  const V wide = hn::Mul(hn::MulAdd(soft, f.vxx, prefilter), hn::MulAdd(soft, f.vyy, prefilter));
  hn::Store(hn::Min(x2, y2), d, out.blur_min2);
  hn::Store(hn::Sqrt(hn::Mul(cx, cy)), d, out.radius);
  hn::Store(out_of_focus_D, d, out.out_of_focus_D);
  return {x2, y2,
          hn::Div(hn::Sqrt(hn::NegMulAdd(hn::Mul(soft2, f.vxy), f.vxy, wide)),
                  hn::Max(hn::Mul(cx, cy), set(1e-12f)))};
}

/// The surfel's slant: its shade by Lambert's cosine against the line of sight, and its tilt
/// (`SplatLens`).
HWY_INLINE void storeSlant(const ProjectJob& job, const Centres& c, const Footprint& f,
                           ProjectedLanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V3 right = rowOf(job, 0), up = rowOf(job, 1);
  const V towards = dot(f.normal, c.p);
  const V away = hn::Mul(towards, c.inv_sight);
  const V tilt_x = hn::Mul(set(-job.blur.x / job.focal.x), dot(right, f.slant));
  const V tilt_y = hn::Mul(set(job.blur.y / job.focal.y), dot(up, f.slant));
  const V tilt = hn::Sqrt(hn::MulAdd(tilt_x, tilt_x, hn::Mul(tilt_y, tilt_y)));
  const V more = hn::Max(hn::Sub(tilt, set(kMinTilt)), hn::Zero(d));
  const V counts = hn::Div(more, hn::Max(tilt, set(kMinTilt)));
  const V shade = hn::MulAdd(set(job.lighting.shading), hn::Sub(hn::Abs(away), one), one);
  hn::Store(hn::Mul(counts, tilt_x), d, out.tilt_x);
  hn::Store(hn::Mul(counts, tilt_y), d, out.tilt_y);
  hn::Store(shade, d, out.shade);
  hn::Store(away, d, out.away);
  hn::Store(towards, d, out.behind_m);
}

/// Whether a sphere about a surfel's support reaches the image once blur and prefilter have moved
/// the image's edges outwards. The Jacobian at its centre would enlarge a surfel beside the eye
/// over the whole image. A sphere of radius r at the depth d meets the plane through the eye and an
/// edge of the image, e pixels from the axis, if its centre is within (r / d) sqrt(f^2 + e^2)
/// pixels of that edge.
/// @param widest2  `Footprint::widest2`
/// @param soft_x   variance of blur and prefilter
HWY_INLINE hn::Mask<D> reachesImage(const ProjectJob& job, const Centres& c, V widest2, V soft_x,
                                    V soft_y) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V margin = set(job.margin);
  const V reach = hn::Mul(hn::Sqrt(hn::Mul(set(kWidestSupport2), widest2)), c.inv_depth);
  const auto alongAxis = [&](V at, V axis, float focal, float size, V soft) {
    const V beyond = hn::Add(margin, hn::Sqrt(hn::Mul(set(kWidestSupport2), soft)));
    const V before = hn::Add(axis, beyond), after = hn::Add(hn::Sub(set(size), axis), beyond);
    const V edge = hn::Max(hn::Abs(before), hn::Abs(after));
    const V reach_px =
        hn::MulAdd(reach, hn::Sqrt(hn::MulAdd(edge, edge, set(focal * focal))), beyond);
    return hn::And(hn::Gt(hn::Add(at, reach_px), hn::Zero(d)),
                   hn::Lt(hn::Sub(at, reach_px), set(size)));
  };
  return hn::And(alongAxis(c.x_px, c.axis_x_px, job.focal.x, job.size.x, soft_x),
                 alongAxis(c.y_px, c.axis_y_px, job.focal.y, job.size.y, soft_y));
}

/// Whether a splat renders anything: in front, on the image, with an area. NaN fails comparisons.
HWY_INLINE hn::Mask<D> isVisible(const ProjectJob& job, const Centres& c, V variance_x,
                                 V variance_y, V area) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V radius_x = hn::Sqrt(hn::Mul(set(kWidestSupport2), variance_x));
  const V radius_y = hn::Sqrt(hn::Mul(set(kWidestSupport2), variance_y));
  auto keep = hn::And(hn::Gt(hn::Add(c.x_px, radius_x), set(-job.margin)),
                      hn::Lt(hn::Sub(c.x_px, radius_x), set(job.size.x + job.margin)));
  keep = hn::And(keep, hn::And(hn::Gt(hn::Add(c.y_px, radius_y), set(-job.margin)),
                               hn::Lt(hn::Sub(c.y_px, radius_y), set(job.size.y + job.margin))));
  keep = hn::And(keep, hn::And(hn::Gt(area, set(0.0f)), hn::Lt(area, set(kLargest_px2))));
  keep = hn::And(
      keep, hn::And(hn::Lt(variance_x, set(kLargest_px2)), hn::Lt(variance_y, set(kLargest_px2))));
  return hn::AndNot(c.too_near, keep);
}

/// Projects surfels [i, i + N), or N nodes.
template <class Source>
HWY_INLINE void projectLanes(const ProjectJob& job, const Source& source, std::size_t i,
                             ProjectedLanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  LocalLanes local;
  PartLens lens{};  // without meaning unless job.field
  const Centres c = projectCentres(job, source, i, local, lens);
  const Footprint f = footprintOf(source, i, c.p, c.to);
  const V reach = hn::Sqrt(hn::MulAdd(hn::Set(d, kReach2), f.along2, f.thick2));
  const V prefilter = prefilterAt(job, c.x_px, c.y_px);
  const BlurVariance blur = blurOf(job, f, c.out_of_focus_D, prefilter, local, lens, out);
  const V narrow = job.gaussian ? hn::Max(blur.narrow, one) : blur.narrow;  // 1: the bell
  const V vxx = hn::MulAdd(f.own, f.vxx, prefilter);
  const V vyy = hn::MulAdd(f.own, f.vyy, prefilter);
  const V vxy = hn::Mul(f.own, f.vxy);
  const V added = hn::Mul(hn::Mul(hn::Set(d, 0.5f), hn::Sub(one, f.own)), hn::Add(f.vxx, f.vyy));
  auto visible = isVisible(job, c, hn::Add(vxx, blur.x2), hn::Add(vyy, blur.y2), f.area);
  visible = hn::And(visible, reachesImage(job, c, f.widest2, hn::Add(prefilter, blur.x2),
                                          hn::Add(prefilter, blur.y2)));

  if (blurs(job) && !job.field && job.astigmatism == 0.0f) {
    const V radius = hn::Max(hn::Load(d, out.radius), hn::Set(d, 1e-6f));
    storeLensScales(radius, hn::Mul(hn::Mul(narrow, radius), radius), prefilter, c.out_of_focus_D,
                    out.lens);
  }
  storeSlant(job, c, f, out);
  hn::Store(c.out_of_focus_D, d, out.defocus_D);
  hn::Store(c.x_px, d, out.x);
  hn::Store(c.y_px, d, out.y);
  hn::Store(vxx, d, out.vxx);
  hn::Store(vxy, d, out.vxy);
  hn::Store(vyy, d, out.vyy);
  hn::Store(prefilter, d, out.prefilter);
  hn::Store(blur.x2, d, out.blur_x2);
  hn::Store(blur.y2, d, out.blur_y2);
  hn::Store(narrow, d, out.narrow);
  hn::Store(added, d, out.added);
  hn::Store(f.area, d, out.area_px);
  hn::Store(c.distance, d, out.distance);
  hn::Store(reach, d, out.reach);
  hn::Store(hn::IfThenElseZero(visible, one), d, out.visible);
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_PROJECT_LANES_INL_H
