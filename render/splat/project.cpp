#include "render/splat/project.h"

#include "app/base/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "render/splat/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef FOCI_PROJECT_ONCE
#define FOCI_PROJECT_ONCE
namespace foci {

/// A kernel's footprint reaches at most this many squared standard deviations (n = 2).
inline constexpr float kWidestSupport2 = 8.0f;

/// The unblurred splat's z-range: its plane within this many squared standard deviations.
inline constexpr float kReach2 = 5.0f;

/// Cosine from which a surfel counts as seen from behind: beyond what normals of a scan err by at
/// its outline.
inline constexpr float kFromBehind = 0.1f;

/// Splats beyond any use are refused: a variance or an area of 10^5 by 10^5 pixels.
inline constexpr float kLargest_px2 = 1e10f;

/// Share of what merging added to a node's variance that is not drawn: where a texture is fine, as
/// much lies in the nodes' places already. See `Projection`.
inline constexpr float kMergedTwice = 1.0f;

/// Light of a single splat at its centre from which, and at twice that most, it counts as sharper.
inline constexpr float kHighlight = 0.06f, kFiner = 0.6f;

/// Of the variance that merging added, what a kernel needs for neighbours to overlap: a square's
/// spread is side^2 / 12, its kernel wants (kSigmaPerSpacing side)^2.
inline constexpr float kOverlap = 12.0f * kSigmaPerSpacing * kSigmaPerSpacing;

/// Surfels one after the other.
struct SurfelArrays {
  const float* position;
  const float* axis_u;
  const float* axis_v;
  const float* area;
  const float* color;
  const float* opacity;  // may be null
};

/// Where splats go; the last three may be null.
struct SplatsOut {
  Splat* splats;
  SplatKey* keys;
  SplatLens* lens;
  Splat* parts;
  SplatLens* part_lens;
  float* out_of_focus_D;
};

/// Up to 16 nodes of a level of detail, side by side.
struct NodeArrays {
  static constexpr std::size_t kMost = 16;
  alignas(64) float position[3][kMost];
  alignas(64) float variance[6][kMost];
  alignas(64) float normal[3][kMost];
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
  float lens_x, lens_y;           // its centre, likewise
  float part_aperture;            // of the smaller parts that it is drawn by too
  bool along_axis;
  bool gaussian;
  bool oriented;
  float shading;
};

}  // namespace foci
#endif  // FOCI_PROJECT_ONCE

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
  alignas(64) float blur_x2[kMost], blur_y2[kMost];      // variance of the blur
  alignas(64) float radius[kMost];                       // of the blur
  alignas(64) float narrow[kMost];  // unblurred variance over the squared blur radius (kernel.h)
  alignas(64) float added[kMost];   // of the unblurred variance, what merging added; one axis
  alignas(64) float out_of_focus_D[kMost];
  alignas(64) float area_px[kMost];
  alignas(64) float distance[kMost], reach[kMost];
  alignas(64) float shade[kMost],
      away[kMost];                   // cosine of the normal to the sight; > 0: away from the eye
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
  V own;            // share of the variance that is drawn
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
  f.own = hn::MulAdd(hn::Set(d, kMergedTwice), hn::Sub(own, hn::Set(d, 1.0f)), hn::Set(d, 1.0f));
  f.normal = {hn::Load(d, nodes.normal[0]), hn::Load(d, nodes.normal[1]),
              hn::Load(d, nodes.normal[2])};
  return f;
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

  // Circle of confusion (Eq. 4 in dioptres) on the variance J V_r J' + I.
  const V defocus_D = hn::Abs(out_of_focus_D);
  const V cx = hn::Mul(set(job.blur_x), defocus_D), cy = hn::Mul(set(job.blur_y), defocus_D);
  const V per_radius2 = set(job.gaussian ? kGaussianVariancePerRadius2 : kDiscVariancePerRadius2);
  const V blur_x2 = hn::Mul(hn::Mul(per_radius2, cx), cx);
  const V blur_y2 = hn::Mul(hn::Mul(per_radius2, cy), cy);
  // Edges so soft that the kernels of neighbouring nodes still sum to one.
  const V soft = hn::MulAdd(hn::Set(d, kOverlap - 1.0f), hn::Sub(one, f.own), one);
  const V soft2 = hn::Mul(soft, soft);
  const V wide = hn::Mul(hn::MulAdd(soft, f.vxx, one), hn::MulAdd(soft, f.vyy, one));
  V narrow = hn::Div(hn::Sqrt(hn::NegMulAdd(hn::Mul(soft2, f.vxy), f.vxy, wide)),
                     hn::Max(hn::Mul(cx, cy), set(1e-12f)));
  if (job.gaussian) narrow = hn::Max(narrow, one);  // the bell
  const V vxx = hn::MulAdd(f.own, f.vxx, one);
  const V vyy = hn::MulAdd(f.own, f.vyy, one);
  const V vxy = hn::Mul(f.own, f.vxy);

  // Lambert's cosine against the line of sight.
  const V away = hn::Mul(dot(f.normal, p), inv_sight);
  const V shade = hn::MulAdd(set(job.shading), hn::Sub(hn::Abs(away), one), one);

  // Keep what draws something: in front, on the image, with an area. Comparisons fail on NaN.
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
  hn::Store(blur_x2, d, out.blur_x2);
  hn::Store(blur_y2, d, out.blur_y2);
  hn::Store(hn::Sqrt(hn::Mul(cx, cy)), d, out.radius);
  hn::Store(narrow, d, out.narrow);
  hn::Store(hn::Mul(hn::Mul(set(0.5f), hn::Sub(one, f.own)), hn::Add(f.vxx, f.vyy)), d, out.added);
  hn::Store(out_of_focus_D, d, out.out_of_focus_D);
  hn::Store(f.area, d, out.area_px);
  hn::Store(distance, d, out.distance);
  hn::Store(reach, d, out.reach);
  hn::Store(shade, d, out.shade);
  hn::Store(away, d, out.away);
  hn::Store(hn::IfThenElseZero(keep, one), d, out.visible);
}

/// What a surfel or node brings along besides its geometry.
struct Paint {
  const float* color;
  float opacity, weight;
};

/// The kernel of lane `k` with variance `widen` V + `blur` V_C (kernel.h). False where it has none.
HWY_INLINE bool setKernel(const Lanes& lanes, std::size_t k, float widen, float blur, float weight,
                          Splat& splat) {
  const KernelShape& shape = kernelShape(kernelExponent(lanes.narrow[k] / std::max(blur, 1e-12f)));

  // Footprint x' R^-1 x < 1 with R = support2 W.
  const float rxx =
      shape.support2 * (1.0f + widen * (lanes.vxx[k] - 1.0f) + blur * lanes.blur_x2[k]);
  const float ryy =
      shape.support2 * (1.0f + widen * (lanes.vyy[k] - 1.0f) + blur * lanes.blur_y2[k]);
  const float rxy = shape.support2 * widen * lanes.vxy[k];
  splat.extent_x_px = std::sqrt(rxx);
  splat.extent_y_px = std::sqrt(ryy);
  const float det = rxx * ryy - rxy * rxy;
  if (!(det > 0.0f)) return false;
  const float inv_det = 1.0f / det;
  splat.qa = ryy * inv_det;
  splat.qb = -2.0f * rxy * inv_det;
  splat.qc = rxx * inv_det;
  const float height = weight * lanes.area_px[k] * std::sqrt(inv_det);
  splat.k0 = shape.k0 * height;
  splat.k1 = shape.k1 * height;
  splat.k2 = shape.k2 * height;
  return true;
}

/// Completes lane `k`. False where it turns out to lie outside the image.
HWY_INLINE bool finishSplat(const ProjectJob& job, const Lanes& lanes, std::size_t k,
                            const Paint& paint, Splat& splat, SplatKey& key) {
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  if (!setKernel(lanes, k, 1.0f, 1.0f, paint.weight, splat)) return false;
  if (!(splat.x_px + splat.extent_x_px > -job.margin &&
        splat.x_px - splat.extent_x_px < job.width + job.margin &&
        splat.y_px + splat.extent_y_px > -job.margin &&
        splat.y_px - splat.extent_y_px < job.height + job.margin)) {
    return false;
  }
  splat.opacity = paint.opacity;
  const float scale = lanes.shade[k] * paint.opacity;
  splat.red = scale * paint.color[0];
  splat.green = scale * paint.color[1];
  splat.blue = scale * paint.color[2];
  if (job.oriented && lanes.away[k] > kFromBehind) splat.opacity = -splat.opacity;
  splat.near_m = std::max(lanes.distance[k] - lanes.reach[k], 0.0f);
  splat.far_m = lanes.distance[k] + lanes.reach[k];

  // Pixels whose centres the footprint's box may reach.
  const auto pixel = [](float px, float size_px) {
    return static_cast<std::uint16_t>(std::clamp(px, 0.0f, size_px - 1.0f));
  };
  // A highlight's own shape shows, others' only in sum: it wants finer samples.
  const float peak =
      (splat.k0 + splat.k1 + splat.k2) * std::max({splat.red, splat.green, splat.blue});
  const float highlight = std::clamp((peak - kHighlight) / kHighlight, 0.0f, 1.0f);
  key = {.near_m = splat.near_m,
         .sigma_px = std::sqrt(1.0f + std::min(lanes.blur_x2[k], lanes.blur_y2[k])) *
                     (1.0f - kFiner * highlight),
         .blur_px = lanes.radius[k],
         .x0 = pixel(splat.x_px - splat.extent_x_px - 0.5f, job.width),
         .x1 = pixel(splat.x_px + splat.extent_x_px - 0.5f, job.width),
         .y0 = pixel(splat.y_px - splat.extent_y_px - 0.5f, job.height),
         .y1 = pixel(splat.y_px + splat.extent_y_px - 0.5f, job.height)};
  return true;
}

/// Which part of the lens sees what of lane `k`, the variance widened and the radius scaled.
HWY_INLINE SplatLens lensOf(const Lanes& lanes, std::size_t k, float widen, float scale) {
  const float radius = std::max(scale * lanes.radius[k], 1e-6f);
  const float variance =  // over the squared radius
      widen * lanes.narrow[k] / (scale * scale);
  const float per_px = 1.0f / (radius * (1.0f + 4.0f * variance));
  const float inv_width = std::sqrt((1.0f / 12.0f) * (1.0f + 4.0f * variance) / variance);
  return {std::copysign(per_px, lanes.out_of_focus_D[k]), inv_width};
}

/// The same splat, blurred by a part of the lens only. Parts are few where nodes are coarse: then
/// it is widened so that neighbours still overlap, and what the blur has of that already is not
/// spread over the lens.
HWY_INLINE void finishPart(const ProjectJob& job, const Lanes& lanes, std::size_t k, float weight,
                           const Splat& whole, Splat& part, SplatLens& lens,
                           float& out_of_focus_D) {
  const float share = job.part_aperture * job.part_aperture;
  const float blur = std::min(lanes.blur_x2[k], lanes.blur_y2[k]);
  const float overlap = kOverlap * lanes.added[k];  // variance, what neighbours need to be one
  const float wanting = std::max(overlap - share * blur, 0.0f);
  const float own = 0.5f * (lanes.vxx[k] + lanes.vyy[k]) - 1.0f;
  const float widen = wanting > 0.0f ? 1.0f + wanting / std::max(own, 1e-12f) : 1.0f;
  part = whole;
  lens = lensOf(lanes, k, widen, job.part_aperture);
  setKernel(lanes, k, widen, share, weight, part);
  const float spread = 1.0f - share - wanting / std::max(blur, 1e-12f);
  out_of_focus_D = lanes.out_of_focus_D[k] * std::sqrt(std::max(spread, 0.0f));
}

/// The lanes that draw something, to consecutive splats.
template <class PaintOf>
HWY_INLINE void finishLanes(const ProjectJob& job, const Lanes& lanes, std::size_t lane_count,
                            const PaintOf& paintOf, const SplatsOut& out, std::uint32_t& count) {
  for (std::size_t k = 0; k < lane_count; ++k) {
    if (lanes.visible[k] == 0.0f) continue;
    const Paint paint = paintOf(k);
    if (!finishSplat(job, lanes, k, paint, out.splats[count], out.keys[count])) continue;
    if (out.lens) out.lens[count] = lensOf(lanes, k, 1.0f, 1.0f);
    if (out.parts) {
      finishPart(job, lanes, k, paint.weight, out.splats[count], out.parts[count],
                 out.part_lens[count], out.out_of_focus_D[count]);
    }
    ++count;
  }
}

/// Copies of surfels, padded to a whole step.
struct SurfelCopies {
  alignas(64) float position[48] = {}, axis_u[48] = {}, axis_v[48] = {}, area[16] = {};

  void set(std::size_t k, const SurfelArrays& from, std::size_t i) {
    std::copy_n(from.position + 3 * i, 3, position + 3 * k);
    std::copy_n(from.axis_u + 3 * i, 3, axis_u + 3 * k);
    std::copy_n(from.axis_v + 3 * i, 3, axis_v + 3 * k);
    area[k] = from.area[i];
  }
  SurfelArrays arrays() const { return {position, axis_u, axis_v, area, nullptr, nullptr}; }
};

/// Projects surfels [begin, end) to consecutive splats; returns their number.
std::uint32_t projectRange(const ProjectJob& job, const SurfelArrays& surfels, std::size_t begin,
                           std::size_t end, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  Lanes lanes;
  std::size_t i = begin;
  const auto paintOf = [&](std::size_t k) {
    return Paint{surfels.color + 3 * (i + k), surfels.opacity ? surfels.opacity[i + k] : 1.0f,
                 1.0f};
  };
  for (; i + n <= end; i += n) {
    projectLanes(job, surfels, i, lanes);
    finishLanes(job, lanes, n, paintOf, out, count);
  }
  if (i < end) {
    SurfelCopies copies;
    for (std::size_t k = 0; k < end - i; ++k) copies.set(k, surfels, i + k);
    projectLanes(job, copies.arrays(), 0, lanes);
    finishLanes(job, lanes, end - i, paintOf, out, count);
  }
  return count;
}

/// Projects some surfels, each with a weight.
std::uint32_t projectSome(const ProjectJob& job, const SurfelArrays& surfels,
                          const CutEntry* entries, std::size_t entry_count, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  Lanes lanes;
  SurfelCopies copies;
  for (std::size_t e = 0; e < entry_count; e += n) {
    const std::size_t some = std::min(n, entry_count - e);
    for (std::size_t k = 0; k < some; ++k) copies.set(k, surfels, entries[e + k].index);
    projectLanes(job, copies.arrays(), 0, lanes);
    const auto paintOf = [&](std::size_t k) {
      const std::size_t i = entries[e + k].index;
      return Paint{surfels.color + 3 * i, surfels.opacity ? surfels.opacity[i] : 1.0f,
                   entries[e + k].weight};
    };
    finishLanes(job, lanes, some, paintOf, out, count);
  }
  return count;
}

/// Projects some nodes, each with a weight.
std::uint32_t projectNodes(const ProjectJob& job, const LodNode* nodes, const CutEntry* entries,
                           std::size_t entry_count, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  Lanes lanes;
  NodeArrays arrays{};
  for (std::size_t e = 0; e < entry_count; e += n) {
    const std::size_t some = std::min(n, entry_count - e);
    for (std::size_t k = 0; k < some; ++k) {
      const LodNode& node = nodes[entries[e + k].index];
      const glm::vec3 normal = unpackNormal(node.normal);
      for (int axis = 0; axis < 3; ++axis) {
        arrays.position[axis][k] = node.position_m[axis];
        arrays.normal[axis][k] = normal[axis];
      }
      for (int m = 0; m < 6; ++m) arrays.variance[m][k] = node.variance_m2[m];
      arrays.density[k] = node.density;
      arrays.own[k] = static_cast<float>(node.own) * (1.0f / 65535.0f);
    }
    projectLanes(job, arrays, 0, lanes);
    const auto paintOf = [&](std::size_t k) {
      const LodNode& node = nodes[entries[e + k].index];
      return Paint{&node.color.x, static_cast<float>(node.opacity) * (1.0f / 65535.0f),
                   entries[e + k].weight};
    };
    finishLanes(job, lanes, some, paintOf, out, count);
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(projectRange);
HWY_EXPORT(projectSome);
HWY_EXPORT(projectNodes);

namespace {

ProjectJob jobOf(bool oriented, const View& view, const Defocus& defocus,
                 const Projection& projection) {
  ProjectJob job{};
  const glm::mat3 rotation(view.eye_from_world);
  const glm::vec3 eye = -glm::transpose(rotation) * glm::vec3(view.eye_from_world[3]);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      job.rotation[3 * row + column] = rotation[column][row];
    }
    job.eye[row] = eye[row];
  }
  job.focal_x = view.focal_px.x;
  job.focal_y = view.focal_px.y;
  job.principal_x = view.principal_px.x;
  job.principal_y = view.principal_px.y;
  job.width = static_cast<float>(view.size_px.x);
  job.height = static_cast<float>(view.size_px.y);
  job.near_m = view.near_m;
  job.margin = static_cast<float>(projection.margin_px);
  job.blur_x = defocus.radius_px_per_D.x * projection.aperture;
  job.blur_y = defocus.radius_px_per_D.y * projection.aperture;
  job.lens_x = defocus.radius_px_per_D.x * projection.lens.x;
  job.lens_y = defocus.radius_px_per_D.y * projection.lens.y;
  job.focus_D = defocus.focus_D;
  job.along_axis = defocus.along == DistanceAlong::axis;
  job.gaussian = projection.kernel == BlurKernel::gaussian;
  job.part_aperture = projection.part_aperture;
  job.oriented = oriented;
  job.shading = projection.shading;
  return job;
}

SurfelArrays arraysOf(const SurfelCloud& cloud) {
  if (cloud.empty()) return {};
  return {&cloud.position_m[0].x, &cloud.axis_u_m[0].x,
          &cloud.axis_v_m[0].x,   cloud.area_m2.data(),
          &cloud.color[0].x,      cloud.opacity.empty() ? nullptr : cloud.opacity.data()};
}

void makeRoom(SplatChunks& chunks, std::size_t splats, bool lens, bool parts) {
  if (chunks.capacity < splats) {
    chunks = {};
    chunks.splats = std::make_unique_for_overwrite<Splat[]>(splats);
    chunks.keys = std::make_unique_for_overwrite<SplatKey[]>(splats);
    chunks.capacity = splats;
  }
  if (!lens) {
    chunks.lens.reset();
  } else if (!chunks.lens) {
    chunks.lens = std::make_unique_for_overwrite<SplatLens[]>(chunks.capacity);
  }
  if (parts && !chunks.parts) {
    chunks.parts = std::make_unique_for_overwrite<Splat[]>(chunks.capacity);
    chunks.part_lens = std::make_unique_for_overwrite<SplatLens[]>(chunks.capacity);
    chunks.out_of_focus_D = std::make_unique_for_overwrite<float[]>(chunks.capacity);
  }
}

SplatsOut outOf(SplatChunks& chunks, std::size_t first, bool parts) {
  return {chunks.splats.get() + first,
          chunks.keys.get() + first,
          chunks.lens ? chunks.lens.get() + first : nullptr,
          parts ? chunks.parts.get() + first : nullptr,
          parts ? chunks.part_lens.get() + first : nullptr,
          parts ? chunks.out_of_focus_D.get() + first : nullptr};
}

// Whole steps a chunk, about as many chunks as the largest machine has threads.
constexpr std::size_t kMostChunks = 64, kStep = 4096;

std::size_t chunkSize(std::size_t n) {
  return std::max(kStep, (n / kMostChunks + kStep) / kStep * kStep);
}

}  // namespace

void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks) {
  const ProjectJob job = jobOf(cloud.oriented, view, defocus, projection);
  const SurfelArrays surfels = arraysOf(cloud);
  const std::size_t n = cloud.size();
  const bool parts = projection.part_aperture > 0.0f;
  makeRoom(chunks, n, job.blur_x > 0.0f && job.blur_y > 0.0f, parts);
  chunks.chunk_size = chunkSize(n);
  chunks.count.assign((n + chunks.chunk_size - 1) / chunks.chunk_size, 0);
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    const std::size_t begin = c * chunks.chunk_size;
    const std::size_t end = std::min(n, begin + chunks.chunk_size);
    chunks.count[c] =
        HWY_DYNAMIC_DISPATCH(projectRange)(job, surfels, begin, end, outOf(chunks, begin, parts));
  });
}

void projectCut(const MomentTree& tree, const Cut& cut, const View& view, const Defocus& defocus,
                const Projection& projection, SplatChunks& chunks) {
  const ProjectJob job = jobOf(tree.surfels().oriented, view, defocus, projection);
  const SurfelArrays surfels = arraysOf(tree.surfels());
  const std::size_t size = chunkSize(cut.nodes.size() + cut.surfels.size());
  const std::size_t node_chunks = (cut.nodes.size() + size - 1) / size;
  const std::size_t chunk_count = node_chunks + (cut.surfels.size() + size - 1) / size;
  const bool parts = projection.part_aperture > 0.0f;
  makeRoom(chunks, chunk_count * size, job.blur_x > 0.0f && job.blur_y > 0.0f, parts);
  chunks.chunk_size = size;
  chunks.count.assign(chunk_count, 0);
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    const bool node = c < node_chunks;
    const std::vector<CutEntry>& entries = node ? cut.nodes : cut.surfels;
    const std::size_t begin = (node ? c : c - node_chunks) * size;
    const std::size_t count = std::min(size, entries.size() - begin);
    const SplatsOut out = outOf(chunks, c * size, parts);
    chunks.count[c] =
        node ? HWY_DYNAMIC_DISPATCH(projectNodes)(job, tree.nodes().data(), entries.data() + begin,
                                                  count, out)
             : HWY_DYNAMIC_DISPATCH(projectSome)(job, surfels, entries.data() + begin, count, out);
  });
}

}  // namespace foci
#endif  // HWY_ONCE
