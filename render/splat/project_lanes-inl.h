// Surfels and nodes of a level of detail to the image, a SIMD step at a time: where they lie, their
// variance, their blur. Included once a SIMD target.
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

#include "render/kernel/limits.h"
#include "render/optics/defocus.h"
#include "render/scene/surfel_cloud.h"

#ifndef FOCI_PROJECT_LANES_ONCE
#define FOCI_PROJECT_LANES_ONCE
namespace foci {

/// How much the longer axis of an ellipse of confusion counts for the kernel's shape. With less,
/// the light of a line is cut off beyond the lens's rim (4 % of its variance at 0); with more,
/// kernels a pixel wide are discs there and sum to one by 2.5 % only (0.3 % here).
inline constexpr float kLongAxis = 0.6f;

/// A tilt (`SplatLens`) is reduced by this: an eye seldom has more.
inline constexpr float kMinTilt = 0.01f;

/// Surfels one after the other.
struct SurfelArrays {
  const float* position;
  const float* axis_u;
  const float* axis_v;
  const float* area;
  const float* color;
  const float* opacity;  // may be null
};

/// Up to 16 nodes of a level of detail, side by side.
struct NodeArrays {
  static constexpr std::size_t kMost = 16;
  alignas(64) float position[3][kMost];
  alignas(64) float variance[6][kMost];
  alignas(64) float normal[2][kMost];  // as `packNormal` packs it
  alignas(64) float density[kMost], own[kMost];
};

/// What all lanes share. The rotation's row r is (r[3 row], r[3 row + 1], r[3 row + 2]).
struct ProjectJob {
  float rotation[9];
  float eye[3];  // in the world
  float focal_x, focal_y, principal_x, principal_y;
  float width, height, near_m;
  float margin;                   // about the image, pixels: splats that only touch it are kept too
  float blur_x, blur_y, focus_D;  // radius in pixels a dioptre, of the part of the lens
  float j0, j45, astigmatism;     // see `Defocus`; the last is their length
  float lens_x, lens_y;           // its centre, likewise
  float part_aperture;            // of the smaller parts that it is rendered by too
  float gaze_x, gaze_y, acuity_base, acuity_per;  // see `Acuity`
  bool along_axis;
  bool gaussian;
  bool oriented;
  float shading;
};

}  // namespace foci
#endif  // FOCI_PROJECT_LANES_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 load3(D d, const float* from) {
  V3 out;
  hn::LoadInterleaved3(d, from, out.x, out.y, out.z);
  return out;
}

HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// Lanes of one step, as the scalar end reads them.
struct Lanes {
  static constexpr std::size_t kMost = 16;
  alignas(64) float x[kMost], y[kMost];
  alignas(64) float vxx[kMost], vxy[kMost], vyy[kMost];  // variance without the blur, px^2
  alignas(64) float prefilter[kMost];                    // variance, of those its part
  alignas(64) float blur_x2[kMost], blur_y2[kMost];      // variance of the blur
  alignas(64) float blur_xy[kMost] = {};                 // 0 but for an astigmatic lens
  alignas(64) float blur_least2[kMost];                  // along the meridian where it is least
  alignas(64) float radius[kMost];                       // of the blur, its largest
  alignas(64) float narrow[kMost];  // unblurred variance over the squared blur radius (kernel.h)
  alignas(64) float unblurred[kMost] = {};  // that variance; of an astigmatic lens only
  alignas(64) float added[kMost];  // of the unblurred variance, what merging added; one axis
  alignas(64) float out_of_focus_D[kMost];         // along the nearest meridian, and across it:
  alignas(64) float out_across_D[kMost] = {};      // of an astigmatic lens only
  alignas(64) float tilt_x[kMost], tilt_y[kMost];  // see `SplatLens`
  alignas(64) float area_px[kMost];
  alignas(64) float distance[kMost], reach[kMost];
  alignas(64) float shade[kMost];
  alignas(64) float away[kMost];     // cosine of the normal to the sight; > 0: away from the eye
  alignas(64) float visible[kMost];  // 1: keep
};

/// How the image and the distance change with a point's place in the world.
struct Gradients {
  V3 x, y;      // pixels a metre
  V3 distance;  // metres a metre
};

/// What projection needs of a step's surfels or nodes, in pixels and metres.
struct Footprint {
  V vxx, vxy, vyy;  // variance on the image, unblurred and without the prefilter
  V area;           // on the image
  V along2;         // variance along the distance
  V thick2;         // variance along the distance that it counts as having at least
  V own;            // share of the variance that is rendered
  V3 normal;        // unit length
};

HWY_INLINE V3 positionOf(const SurfelArrays& surfels, std::size_t i) {
  return load3(D(), surfels.position + 3 * i);
}

HWY_INLINE Footprint footprintOf(const SurfelArrays& surfels, std::size_t i, const Gradients& to) {
  const D d;
  const V3 u = load3(d, surfels.axis_u + 3 * i), v = load3(d, surfels.axis_v + 3 * i);
  const V ux = dot(to.x, u), uy = dot(to.y, u), vx = dot(to.x, v), vy = dot(to.y, v);
  const V u_along = dot(to.distance, u), v_along = dot(to.distance, v);
  const V uu = dot(u, u), vv = dot(v, v);
  const V inv_parallelogram = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Mul(uu, vv)));
  const V3 normal{hn::NegMulAdd(u.z, v.y, hn::Mul(u.y, v.z)),
                  hn::NegMulAdd(u.x, v.z, hn::Mul(u.z, v.x)),
                  hn::NegMulAdd(u.y, v.x, hn::Mul(u.x, v.y))};
  Footprint f;
  f.vxx = hn::MulAdd(ux, ux, hn::Mul(vx, vx));
  f.vyy = hn::MulAdd(uy, uy, hn::Mul(vy, vy));
  f.vxy = hn::MulAdd(ux, uy, hn::Mul(vx, vy));
  // Area |det J| over the parallelogram of the axes.
  const V det_j = hn::Abs(hn::NegMulAdd(uy, vx, hn::Mul(ux, vy)));
  f.area = hn::Mul(hn::LoadU(d, surfels.area + i), hn::Mul(det_j, inv_parallelogram));
  f.along2 = hn::MulAdd(u_along, u_along, hn::Mul(v_along, v_along));
  // A surfel counts as at least as thick as it is wide: samples of one scanned surface scatter
  // about it.
  f.thick2 = hn::Max(uu, vv);
  f.own = hn::Set(d, 1.0f);
  f.normal = {hn::Mul(normal.x, inv_parallelogram), hn::Mul(normal.y, inv_parallelogram),
              hn::Mul(normal.z, inv_parallelogram)};
  return f;
}

HWY_INLINE V3 positionOf(const NodeArrays& nodes, std::size_t) {
  const D d;
  return {hn::Load(d, nodes.position[0]), hn::Load(d, nodes.position[1]),
          hn::Load(d, nodes.position[2])};
}

/// As `unpackNormal`.
HWY_INLINE V3 unpackNormals(const NodeArrays& nodes) {
  const D d;
  const V scale = hn::Set(d, 1.0f / 32767.0f);
  const V x = hn::Mul(scale, hn::Load(d, nodes.normal[0]));
  const V y = hn::Mul(scale, hn::Load(d, nodes.normal[1]));
  const V z = hn::Sub(hn::Sub(hn::Set(d, 1.0f), hn::Abs(x)), hn::Abs(y));
  const V fold = hn::Max(hn::Neg(z), hn::Zero(d));
  const V3 n{hn::Sub(x, hn::CopySign(fold, x)), hn::Sub(y, hn::CopySign(fold, y)), z};
  const V inv = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot(n, n)));
  return {hn::Mul(n.x, inv), hn::Mul(n.y, inv), hn::Mul(n.z, inv)};
}

HWY_INLINE Footprint footprintOf(const NodeArrays& nodes, std::size_t, const Gradients& to) {
  const D d;
  const V xx = hn::Load(d, nodes.variance[0]), xy = hn::Load(d, nodes.variance[1]);
  const V xz = hn::Load(d, nodes.variance[2]), yy = hn::Load(d, nodes.variance[3]);
  const V yz = hn::Load(d, nodes.variance[4]), zz = hn::Load(d, nodes.variance[5]);
  const auto times = [&](const V3& a) {
    return V3{hn::MulAdd(xx, a.x, hn::MulAdd(xy, a.y, hn::Mul(xz, a.z))),
              hn::MulAdd(xy, a.x, hn::MulAdd(yy, a.y, hn::Mul(yz, a.z))),
              hn::MulAdd(xz, a.x, hn::MulAdd(yz, a.y, hn::Mul(zz, a.z)))};
  };
  const V3 x = times(to.x);
  Footprint f;
  f.vxx = dot(to.x, x);
  f.vxy = dot(to.y, x);
  f.vyy = dot(to.y, times(to.y));
  const V det = hn::NegMulAdd(f.vxy, f.vxy, hn::Mul(f.vxx, f.vyy));
  f.area = hn::Mul(hn::Load(d, nodes.density), hn::Sqrt(hn::Max(det, hn::Zero(d))));
  f.along2 = dot(to.distance, times(to.distance));
  const V own = hn::Load(d, nodes.own);
  f.thick2 = hn::Mul(hn::Mul(hn::Set(d, 0.5f), own), hn::Add(xx, hn::Add(yy, zz)));
  f.own = own;
  f.normal = unpackNormals(nodes);
  return f;
}

/// An ellipse of confusion on unblurred splats: what projectLanes needs of it.
struct Ellipse {
  V blur_x2, blur_y2, narrow;
};

/// Blur of variance k B B', B = diag(r) (F - I/U), on splats of variance `sharp`, prefilter
/// included. With f1 >= f2 the blur's shares of W along its principal axes, the kernel with the
/// mean fourth moment of disc and Gaussian (of q, over W) is that of a disc whose share f has
///   f^2 = (3 f1^2 + 3 f2^2 + 2 f1 f2) / 8,
/// f itself where f1 = f2 = f. A line's is a bell, longer than the line; so kLongAxis of f^2 is
/// f1^2.
HWY_INLINE Ellipse blurEllipse(const ProjectJob& job, V out_of_focus_D, V sharp_xx, V sharp_xy,
                               V sharp_yy, Lanes& out) {
  const D d;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const float k = job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2;
  const V j45 = set(job.j45), astigmatism = set(job.astigmatism);
  const V fx = hn::Add(out_of_focus_D, set(job.j0)), fy = hn::Sub(out_of_focus_D, set(job.j0));
  const V bxx = hn::Mul(set(k * job.blur_x * job.blur_x), hn::MulAdd(fx, fx, hn::Mul(j45, j45)));
  const V byy = hn::Mul(set(k * job.blur_y * job.blur_y), hn::MulAdd(fy, fy, hn::Mul(j45, j45)));
  const V bxy = hn::Mul(set(2.0f * k * job.blur_x * job.blur_y * job.j45), out_of_focus_D);

  const V mean_D = hn::Abs(out_of_focus_D), least_D = hn::Sub(mean_D, astigmatism);
  const float narrowest = std::min(job.blur_x, job.blur_y);
  const float radius = std::sqrt(job.blur_x * job.blur_y);
  hn::Store(bxy, d, out.blur_xy);
  hn::Store(hn::Mul(set(k * narrowest * narrowest), hn::Mul(least_D, least_D)), d, out.blur_least2);
  hn::Store(hn::Mul(set(radius), hn::Add(mean_D, astigmatism)), d, out.radius);
  hn::Store(hn::Add(out_of_focus_D, astigmatism), d, out.out_of_focus_D);
  hn::Store(hn::Sub(out_of_focus_D, astigmatism), d, out.out_across_D);
  const V sharp_det = hn::NegMulAdd(sharp_xy, sharp_xy, hn::Mul(sharp_xx, sharp_yy));
  hn::Store(hn::Sqrt(hn::Max(sharp_det, hn::Zero(d))), d, out.unblurred);

  // f1 + f2 = tr(W^-1 B), f1 f2 = |B| / |W|, B here the blur's variance.
  const V wxx = hn::Add(sharp_xx, bxx), wxy = hn::Add(sharp_xy, bxy);
  const V wyy = hn::Add(sharp_yy, byy);
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
  return {bxx, byy, hn::Max(narrow, hn::Zero(d))};
}

/// Surfels [i, i + N), or N nodes, to lanes.
template <class Source>
HWY_INLINE void projectLanes(const ProjectJob& job, const Source& source, std::size_t i,
                             Lanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };
  const auto row = [&](int r) {
    return V3{set(job.rotation[3 * r]), set(job.rotation[3 * r + 1]), set(job.rotation[3 * r + 2])};
  };
  const V3 right = row(0), up = row(1), back = row(2);

  // From the eye, in the world's directions; then the eye's own.
  V3 p = positionOf(source, i);
  p = {hn::Sub(p.x, set(job.eye[0])), hn::Sub(p.y, set(job.eye[1])), hn::Sub(p.z, set(job.eye[2]))};

  // Perspective and its Jacobian at the centre: x = c_x + f_x X / d, y = c_y - f_y Y / d, d = -Z.
  const V depth = hn::Neg(dot(back, p));
  const auto before_near = hn::Lt(depth, set(job.near_m));
  const V inv_depth = hn::Div(one, hn::Max(depth, set(job.near_m)));
  const V tx = hn::Mul(dot(right, p), inv_depth), ty = hn::Mul(dot(up, p), inv_depth);
  V x_px = hn::MulAdd(set(job.focal_x), tx, set(job.principal_x));
  V y_px = hn::NegMulAdd(set(job.focal_y), ty, set(job.principal_y));
  const V sx = hn::Mul(set(job.focal_x), inv_depth), sy = hn::Mul(set(-job.focal_y), inv_depth);

  // Distance along the sight or the axis.
  const V sight2 = dot(p, p);
  const V inv_sight = hn::Div(one, hn::Sqrt(sight2));
  const V distance = job.along_axis ? depth : hn::Mul(sight2, inv_sight);
  const V inv_distance = job.along_axis ? hn::Div(one, distance) : inv_sight;

  // Seen from the part's centre: the image moves with the vergence, and so does the Jacobian.
  const V out_of_focus_D = hn::Sub(set(job.focus_D), inv_distance);
  x_px = hn::MulAdd(set(job.lens_x), out_of_focus_D, x_px);
  y_px = hn::MulAdd(set(job.lens_y), out_of_focus_D, y_px);
  const V slope = hn::Mul(inv_distance, inv_distance);
  const V slope_x = hn::Mul(set(job.lens_x), slope), slope_y = hn::Mul(set(job.lens_y), slope);
  Gradients to;
  const auto gradients = [&](V p_axis, V right_axis, V up_axis, V back_axis, V& x, V& y, V& along) {
    along = job.along_axis ? hn::Neg(back_axis) : hn::Mul(p_axis, inv_sight);
    x = hn::MulAdd(slope_x, along, hn::Mul(sx, hn::MulAdd(back_axis, tx, right_axis)));
    y = hn::MulAdd(slope_y, along, hn::Mul(sy, hn::MulAdd(back_axis, ty, up_axis)));
  };
  gradients(p.x, right.x, up.x, back.x, to.x.x, to.y.x, to.distance.x);
  gradients(p.y, right.y, up.y, back.y, to.x.y, to.y.y, to.distance.y);
  gradients(p.z, right.z, up.z, back.z, to.x.z, to.y.z, to.distance.z);

  const Footprint f = footprintOf(source, i, to);
  const V reach = hn::Sqrt(hn::MulAdd(set(kReach2), f.along2, f.thick2));

  // The prefilter, as wide as the observer's acuity there asks for.
  const V gaze_dx = hn::Sub(x_px, set(job.gaze_x)), gaze_dy = hn::Sub(y_px, set(job.gaze_y));
  const V from_gaze = hn::Sqrt(hn::MulAdd(gaze_dx, gaze_dx, hn::Mul(gaze_dy, gaze_dy)));
  const V finest = hn::Max(hn::MulAdd(set(job.acuity_per), from_gaze, set(job.acuity_base)), one);
  const V prefilter = hn::Mul(finest, finest);

  // Circle of confusion (Eq. 4 in dioptres) on the variance J V_r J' + prefilter.
  const V defocus_D = hn::Abs(out_of_focus_D);
  const V cx = hn::Mul(set(job.blur_x), defocus_D), cy = hn::Mul(set(job.blur_y), defocus_D);
  const V per_radius2 = set(job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2);
  V blur_x2 = hn::Mul(hn::Mul(per_radius2, cx), cx);
  V blur_y2 = hn::Mul(hn::Mul(per_radius2, cy), cy);
  // Edges so soft that the kernels of neighbouring nodes still sum to one.
  const V soft = hn::MulAdd(hn::Set(d, kOverlap - 1.0f), hn::Sub(one, f.own), one);
  const V soft2 = hn::Mul(soft, soft);
  V narrow;
  if (job.astigmatism == 0.0f) {
    const V wide = hn::Mul(hn::MulAdd(soft, f.vxx, prefilter), hn::MulAdd(soft, f.vyy, prefilter));
    narrow = hn::Div(hn::Sqrt(hn::NegMulAdd(hn::Mul(soft2, f.vxy), f.vxy, wide)),
                     hn::Max(hn::Mul(cx, cy), set(1e-12f)));
    hn::Store(hn::Min(blur_x2, blur_y2), d, out.blur_least2);
    hn::Store(hn::Sqrt(hn::Mul(cx, cy)), d, out.radius);
    hn::Store(out_of_focus_D, d, out.out_of_focus_D);
  } else {
    const Ellipse ellipse =
        blurEllipse(job, out_of_focus_D, hn::MulAdd(soft, f.vxx, prefilter), hn::Mul(soft, f.vxy),
                    hn::MulAdd(soft, f.vyy, prefilter), out);
    blur_x2 = ellipse.blur_x2;
    blur_y2 = ellipse.blur_y2;
    narrow = ellipse.narrow;
  }
  if (job.gaussian) narrow = hn::Max(narrow, one);  // the bell
  const V vxx = hn::MulAdd(f.own, f.vxx, prefilter);
  const V vyy = hn::MulAdd(f.own, f.vyy, prefilter);
  const V vxy = hn::Mul(f.own, f.vxy);

  // Lambert's cosine against the line of sight.
  const V towards = dot(f.normal, p);
  const V away = hn::Mul(towards, inv_sight);
  const V inv = hn::Div(one, hn::CopySign(hn::Max(hn::Abs(towards), set(1e-20f)), towards));
  const V tilt_x = hn::Mul(hn::Mul(set(-job.blur_x / job.focal_x), dot(right, f.normal)), inv);
  const V tilt_y = hn::Mul(hn::Mul(set(job.blur_y / job.focal_y), dot(up, f.normal)), inv);
  const V tilt = hn::Sqrt(hn::MulAdd(tilt_x, tilt_x, hn::Mul(tilt_y, tilt_y)));
  const V more = hn::Max(hn::Sub(tilt, set(kMinTilt)), hn::Zero(d));
  const V counts = hn::Div(more, hn::Max(tilt, set(kMinTilt)));
  const V shade = hn::MulAdd(set(job.shading), hn::Sub(hn::Abs(away), one), one);

  // Keep what renders something: in front, on the image, with an area. Comparisons fail on NaN.
  const V all_x2 = hn::Add(vxx, blur_x2), all_y2 = hn::Add(vyy, blur_y2);
  const V radius_x = hn::Sqrt(hn::Mul(set(kWidestSupport2), all_x2));
  const V radius_y = hn::Sqrt(hn::Mul(set(kWidestSupport2), all_y2));
  auto keep = hn::And(hn::Gt(hn::Add(x_px, radius_x), set(-job.margin)),
                      hn::Lt(hn::Sub(x_px, radius_x), set(job.width + job.margin)));
  keep = hn::And(keep, hn::And(hn::Gt(hn::Add(y_px, radius_y), set(-job.margin)),
                               hn::Lt(hn::Sub(y_px, radius_y), set(job.height + job.margin))));
  keep = hn::And(keep, hn::And(hn::Gt(f.area, set(0.0f)), hn::Lt(f.area, set(kLargest_px2))));
  keep =
      hn::And(keep, hn::And(hn::Lt(all_x2, set(kLargest_px2)), hn::Lt(all_y2, set(kLargest_px2))));
  keep = hn::AndNot(before_near, keep);

  hn::Store(x_px, d, out.x);
  hn::Store(y_px, d, out.y);
  hn::Store(vxx, d, out.vxx);
  hn::Store(vxy, d, out.vxy);
  hn::Store(vyy, d, out.vyy);
  hn::Store(prefilter, d, out.prefilter);
  hn::Store(blur_x2, d, out.blur_x2);
  hn::Store(blur_y2, d, out.blur_y2);
  hn::Store(narrow, d, out.narrow);
  hn::Store(hn::Mul(hn::Mul(set(0.5f), hn::Sub(one, f.own)), hn::Add(f.vxx, f.vyy)), d, out.added);
  hn::Store(hn::Mul(counts, tilt_x), d, out.tilt_x);
  hn::Store(hn::Mul(counts, tilt_y), d, out.tilt_y);
  hn::Store(f.area, d, out.area_px);
  hn::Store(distance, d, out.distance);
  hn::Store(reach, d, out.reach);
  hn::Store(shade, d, out.shade);
  hn::Store(away, d, out.away);
  hn::Store(hn::IfThenElseZero(keep, one), d, out.visible);
}

/// Which part of the lens sees what of lane `k`.
HWY_INLINE SplatLens lensOf(const Lanes& lanes, std::size_t k) {
  const float radius = std::max(lanes.radius[k], 1e-6f);
  const float variance = lanes.narrow[k];  // over the squared radius
  const float per_px = 1.0f / (radius * (1.0f + 4.0f * variance));
  const float inv_width = std::sqrt((1.0f / 12.0f) * (1.0f + 4.0f * variance) / variance);
  return {std::copysign(per_px, lanes.out_of_focus_D[k]), inv_width, lanes.tilt_x[k],
          lanes.tilt_y[k]};
}

/// Which part of an astigmatic lens sees what of lane `k`, by place along one of its meridians that
/// is out of focus by `off_D`.
HWY_INLINE SplatLens lensAlong(const ProjectJob& job, const Lanes& lanes, std::size_t k,
                               float off_D) {
  const float radius = std::sqrt(job.blur_x * job.blur_y) * off_D;
  const float variance4 = 4.0f * lanes.unblurred[k];
  const float sum = radius * radius + variance4;
  return {radius / sum, std::sqrt(sum / (3.0f * variance4)), lanes.tilt_x[k], lanes.tilt_y[k]};
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_PROJECT_LANES_INL_H
