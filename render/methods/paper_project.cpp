#include "render/methods/paper_project.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/methods/circumellipse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/methods/paper_project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef FOCI_PAPER_PROJECT_ONCE
#define FOCI_PAPER_PROJECT_ONCE
namespace foci {

/// Splats beyond any use are refused: a variance or an area of 10^5 by 10^5 pixels.
inline constexpr float kLargestPaperSplat_px2 = 1e10f;

/// Half of a z-range over the depth, at least: coordinates are rounded, and the splats of a plane
/// that faces the eye would not meet.
inline constexpr float kThinnestRange = 1e-5f;

/// What the lanes need, flat. The frame's row r of the rotation is (r[3 row], r[3 row + 1], r[3 row
/// + 2]).
struct PaperProjectJob {
  const float* position;
  const float* axis_u;
  const float* axis_v;
  const float* spread_u;  // null: no low-pass filter
  const float* spread_v;
  const float* color;
  const float* opacity;  // null: all 1
  const float* area;
  float rotation[9];
  float translation[3];
  float focal_x, focal_y, principal_x, principal_y;
  float width, height, near_m;
  float blur_x, blur_y, focus_D;  // radius in pixels a dioptre
  float blur_y_per_x;
  float j0, j45;  // see `Defocus`
  bool astigmatic;
  bool along_axis;
  float shading;
  float rim_per_area;  // height of a truncated Gaussian of area and determinant 1 at its rim
};

}  // namespace foci
#endif  // FOCI_PAPER_PROJECT_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

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

HWY_INLINE V3 rotate(D d, const float* r, const V3& p) {
  const auto row = [&](int i) {
    return hn::MulAdd(
        hn::Set(d, r[3 * i]), p.x,
        hn::MulAdd(hn::Set(d, r[3 * i + 1]), p.y, hn::Mul(hn::Set(d, r[3 * i + 2]), p.z)));
  };
  return {row(0), row(1), row(2)};
}

HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// The affine map to the screen around one point: how a vector falls on it.
struct Jacobian {
  V sx, sy, tx, ty;
  HWY_INLINE V x(const V3& a) const { return hn::Mul(sx, hn::MulAdd(a.z, tx, a.x)); }
  HWY_INLINE V y(const V3& a) const { return hn::Mul(sy, hn::MulAdd(a.z, ty, a.y)); }
};

constexpr std::size_t kMaxLanes = 16;

/// Lanes of one step, as the scalar end reads them.
struct Lanes {
  alignas(64) float x[kMaxLanes], y[kMaxLanes];
  alignas(64) float wxx[kMaxLanes], wxy[kMaxLanes], wyy[kMaxLanes], det[kMaxLanes];  // of W
  alignas(64) float area_px[kMaxLanes];
  alignas(64) float distance[kMaxLanes], near_m[kMaxLanes], far_m[kMaxLanes];
  alignas(64) float shade[kMaxLanes];
  alignas(64) float visible[kMaxLanes];  // 1: keep
};

/// circumellipse(B, V_C) with V_C = a diag(C_x^2, C_y^2): where y is scaled by C_x / C_y, V_C is a
/// circle.
HWY_INLINE void circumellipseLanes(float y_per_x, V& bxx, V& bxy, V& byy, V circle) {
  const D d;
  alignas(64) float xx[kMaxLanes], xy[kMaxLanes], yy[kMaxLanes], c[kMaxLanes];
  hn::Store(bxx, d, xx);
  hn::Store(bxy, d, xy);
  hn::Store(byy, d, yy);
  hn::Store(circle, d, c);
  const float x_per_y = 1.0f / y_per_x;
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    const Variance w = circumellipse({xx[k], xy[k] * x_per_y, yy[k] * x_per_y * x_per_y}, c[k]);
    xx[k] = w.xx;
    xy[k] = w.xy * y_per_x;
    yy[k] = w.yy * y_per_x * y_per_x;
  }
  bxx = hn::Load(d, xx);
  bxy = hn::Load(d, xy);
  byy = hn::Load(d, yy);
}

/// circumellipse(B, V_C), lane by lane, into B.
HWY_INLINE void circumellipseLanes(V& bxx, V& bxy, V& byy, V cxx, V cxy, V cyy) {
  const D d;
  alignas(64) float b[3][kMaxLanes], c[3][kMaxLanes];
  hn::Store(bxx, d, b[0]);
  hn::Store(bxy, d, b[1]);
  hn::Store(byy, d, b[2]);
  hn::Store(cxx, d, c[0]);
  hn::Store(cxy, d, c[1]);
  hn::Store(cyy, d, c[2]);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    const Variance w =
        circumellipse({b[0][k], b[1][k], b[2][k]}, Variance{c[0][k], c[1][k], c[2][k]});
    b[0][k] = w.xx;
    b[1][k] = w.xy;
    b[2][k] = w.yy;
  }
  bxx = hn::Load(d, b[0]);
  bxy = hn::Load(d, b[1]);
  byy = hn::Load(d, b[2]);
}

/// Surfels [i, i + N) to lanes.
HWY_INLINE void projectLanes(const PaperProjectJob& job, std::size_t i, Lanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };

  // Into the eye frame.
  V3 p = rotate(d, job.rotation, load3(d, job.position + 3 * i));
  p = {hn::Add(p.x, set(job.translation[0])), hn::Add(p.y, set(job.translation[1])),
       hn::Add(p.z, set(job.translation[2]))};
  const V3 u = rotate(d, job.rotation, load3(d, job.axis_u + 3 * i));
  const V3 v = rotate(d, job.rotation, load3(d, job.axis_v + 3 * i));

  // Perspective and its Jacobian at the centre: x = c_x + f_x X / z, y = c_y - f_y Y / z, z = -Z.
  const V depth = hn::Neg(p.z);
  const auto before_near = hn::Lt(depth, set(job.near_m));
  const V inv_depth = hn::Div(one, hn::Max(depth, set(job.near_m)));
  const Jacobian jacobian{hn::Mul(set(job.focal_x), inv_depth),
                          hn::Mul(set(-job.focal_y), inv_depth), hn::Mul(p.x, inv_depth),
                          hn::Mul(p.y, inv_depth)};
  const V x_px = hn::MulAdd(set(job.focal_x), jacobian.tx, set(job.principal_x));
  const V y_px = hn::NegMulAdd(set(job.focal_y), jacobian.ty, set(job.principal_y));
  const V ux = jacobian.x(u), uy = jacobian.y(u), vx = jacobian.x(v), vy = jacobian.y(v);

  // J V_r J'.
  const V rxx = hn::MulAdd(ux, ux, hn::Mul(vx, vx));
  const V rxy = hn::MulAdd(ux, uy, hn::Mul(vx, vy));
  const V ryy = hn::MulAdd(uy, uy, hn::Mul(vy, vy));

  // V_C (Eq. 4 in dioptres), or what covers it and the low-pass filter; with the prefilter, K.
  const V distance = job.along_axis ? depth : hn::Sqrt(dot(p, p));
  const V out_of_focus_D = hn::Sub(set(job.focus_D), hn::Div(one, distance));
  const V defocus_D = hn::Abs(out_of_focus_D);
  V cx = hn::Mul(set(job.blur_x), defocus_D), cy = hn::Mul(set(job.blur_y), defocus_D);
  V kxx = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), cx), cx);
  V kyy = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), cy), cy);
  V kxy = hn::Zero(d);
  if (job.astigmatic) {  // of an ellipse of confusion, cx and cy are half the box about it
    const V j45 = set(job.j45), fx = hn::Add(out_of_focus_D, set(job.j0));
    const V fy = hn::Sub(out_of_focus_D, set(job.j0));
    cx = hn::Mul(set(job.blur_x), hn::Sqrt(hn::MulAdd(fx, fx, hn::Mul(j45, j45))));
    cy = hn::Mul(set(job.blur_y), hn::Sqrt(hn::MulAdd(fy, fy, hn::Mul(j45, j45))));
    kxx = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), cx), cx);
    kyy = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), cy), cy);
    kxy = hn::Mul(set(2.0f * kGaussianVariancePerRadius2 * job.blur_x * job.blur_y * job.j45),
                  out_of_focus_D);
  }
  V filter2 = hn::Zero(d);
  if (job.spread_u) {
    const V3 lu = rotate(d, job.rotation, load3(d, job.spread_u + 3 * i));
    const V3 lv = rotate(d, job.rotation, load3(d, job.spread_v + 3 * i));
    const V lux = jacobian.x(lu), luy = jacobian.y(lu), lvx = jacobian.x(lv), lvy = jacobian.y(lv);
    filter2 = hn::MulAdd(lu.z, lu.z, hn::Mul(lv.z, lv.z));
    const V circle = kxx, blur_xy = kxy, blur_yy = kyy;
    kxx = hn::MulAdd(lux, lux, hn::Mul(lvx, lvx));
    kxy = hn::MulAdd(lux, luy, hn::Mul(lvx, lvy));
    kyy = hn::MulAdd(luy, luy, hn::Mul(lvy, lvy));
    if (job.astigmatic) {
      circumellipseLanes(kxx, kxy, kyy, circle, blur_xy, blur_yy);
    } else {
      circumellipseLanes(job.blur_y_per_x, kxx, kxy, kyy, circle);
    }
  }
  kxx = hn::Add(kxx, one);
  kyy = hn::Add(kyy, one);

  // W, and its determinant from parts that do not cancel: W may be long and thin.
  const V wxx = hn::Add(rxx, kxx), wxy = hn::Add(rxy, kxy), wyy = hn::Add(ryy, kyy);
  const V det_j = hn::NegMulAdd(uy, vx, hn::Mul(ux, vy));
  const V mixed = hn::NegMulAdd(hn::Add(rxy, rxy), kxy, hn::MulAdd(rxx, kyy, hn::Mul(ryy, kxx)));
  const V det =
      hn::Add(hn::MulAdd(det_j, det_j, mixed), hn::NegMulAdd(kxy, kxy, hn::Mul(kxx, kyy)));

  // Projected area: area |det J| over the parallelogram of the axes.
  const V3 cross{hn::NegMulAdd(u.z, v.y, hn::Mul(u.y, v.z)),
                 hn::NegMulAdd(u.x, v.z, hn::Mul(u.z, v.x)),
                 hn::NegMulAdd(u.y, v.x, hn::Mul(u.x, v.y))};
  const V parallelogram = hn::Sqrt(dot(cross, cross));
  const V area_px = hn::Mul(hn::LoadU(d, job.area + i), hn::Div(hn::Abs(det_j), parallelogram));

  // z-range: depth changes across the plane by sin, the sine of its tilt, times the way. Blur and
  // prefilter, brought back from the screen to the surfel, widen the basis alike in all directions.
  const V along_normal = dot(cross, p);
  const V sin2 = hn::Div(hn::MulAdd(cross.x, cross.x, hn::Mul(cross.y, cross.y)),
                         hn::Mul(parallelogram, parallelogram));
  const V unit_x = hn::Mul(depth, set(1.0f / job.focal_x));
  const V unit_y = hn::Mul(depth, set(1.0f / job.focal_y));
  const V pixel2 = hn::Mul(hn::Max(hn::Mul(unit_x, unit_x), hn::Mul(unit_y, unit_y)), sin2);
  const V blur_m = hn::Max(hn::Mul(unit_x, cx), hn::Mul(unit_y, cy));
  const V blur2 = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), hn::Mul(blur_m, blur_m)), sin2);
  const V along2 =
      hn::Add(hn::MulAdd(u.z, u.z, hn::Mul(v.z, v.z)), hn::Add(pixel2, hn::Max(filter2, blur2)));
  const V least = hn::Mul(set(kThinnestRange), depth);
  const V reach = hn::Sqrt(hn::MulAdd(set(2.0f * kPaperCutoff), along2, hn::Mul(least, least)));
  const V near_m = hn::Sub(depth, reach), far_m = hn::Add(depth, reach);

  // Lambert's cosine against the line of sight.
  const V cosine = hn::Div(hn::Abs(along_normal), hn::Mul(parallelogram, hn::Sqrt(dot(p, p))));
  const V shade = hn::MulAdd(set(job.shading), hn::Sub(cosine, one), one);

  // Keep what renders something: in front, on the image, with an area. Comparisons fail on NaN.
  const V radius_x = hn::Sqrt(hn::Mul(set(2.0f * kPaperCutoff), wxx));
  const V radius_y = hn::Sqrt(hn::Mul(set(2.0f * kPaperCutoff), wyy));
  auto keep = hn::And(hn::Gt(hn::Add(x_px, radius_x), set(0.0f)),
                      hn::Lt(hn::Sub(x_px, radius_x), set(job.width)));
  keep = hn::And(keep, hn::And(hn::Gt(hn::Add(y_px, radius_y), set(0.0f)),
                               hn::Lt(hn::Sub(y_px, radius_y), set(job.height))));
  const V largest = set(kLargestPaperSplat_px2);
  keep = hn::And(keep, hn::And(hn::Gt(area_px, hn::Zero(d)), hn::Lt(area_px, largest)));
  keep = hn::And(keep, hn::And(hn::Lt(wxx, largest), hn::Lt(wyy, largest)));
  keep = hn::And(keep, hn::Gt(det, hn::Zero(d)));
  keep = hn::And(keep, hn::Le(near_m, far_m));
  keep = hn::AndNot(before_near, keep);

  hn::Store(x_px, d, out.x);
  hn::Store(y_px, d, out.y);
  hn::Store(wxx, d, out.wxx);
  hn::Store(wxy, d, out.wxy);
  hn::Store(wyy, d, out.wyy);
  hn::Store(det, d, out.det);
  hn::Store(area_px, d, out.area_px);
  hn::Store(distance, d, out.distance);
  hn::Store(near_m, d, out.near_m);
  hn::Store(far_m, d, out.far_m);
  hn::Store(shade, d, out.shade);
  hn::Store(hn::IfThenElseZero(keep, one), d, out.visible);
}

/// Completes lane `k`, surfel `i`.
HWY_INLINE void finishSplat(const PaperProjectJob& job, const Lanes& lanes, std::size_t k,
                            std::size_t i, PaperSplat& splat, PaperSplatTiles& tiles) {
  const float half_inv_det = 0.5f / lanes.det[k];
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  splat.qa = lanes.wyy[k] * half_inv_det;
  splat.qb = -2.0f * lanes.wxy[k] * half_inv_det;
  splat.qc = lanes.wxx[k] * half_inv_det;
  splat.height = job.rim_per_area * lanes.area_px[k] / std::sqrt(lanes.det[k]);
  splat.opacity = job.opacity ? job.opacity[i] : 1.0f;
  const float scale = lanes.shade[k] * splat.opacity;
  splat.red = scale * job.color[3 * i];
  splat.green = scale * job.color[3 * i + 1];
  splat.blue = scale * job.color[3 * i + 2];
  splat.near_m = lanes.near_m[k];
  splat.far_m = lanes.far_m[k];
  splat.distance_m = lanes.distance[k];
  splat.extent_x_px = std::sqrt(2.0f * kPaperCutoff * lanes.wxx[k]);
  splat.extent_y_px = std::sqrt(2.0f * kPaperCutoff * lanes.wyy[k]);

  // Tiles whose pixel centres the footprint's box may reach.
  const auto tile = [](float px, float size_px) {
    return static_cast<std::uint16_t>(std::clamp(px, 0.0f, size_px - 1.0f) *
                                      (1.0f / kPaperTile_px));
  };
  tiles = {.x0 = tile(splat.x_px - splat.extent_x_px - 0.5f, job.width),
           .x1 = tile(splat.x_px + splat.extent_x_px - 0.5f, job.width),
           .y0 = tile(splat.y_px - splat.extent_y_px - 0.5f, job.height),
           .y1 = tile(splat.y_px + splat.extent_y_px - 0.5f, job.height)};
}

}  // namespace

std::uint32_t projectPaperSurfels(const PaperProjectJob& job, std::size_t count, PaperSplat* splats,
                                  PaperSplatTiles* tiles) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  std::uint32_t rendered = 0;
  Lanes lanes;
  const auto finish = [&](std::size_t first, std::size_t of_step) {
    for (std::size_t k = 0; k < of_step; ++k) {
      if (lanes.visible[k] == 0.0f) continue;
      finishSplat(job, lanes, k, first + k, splats[rendered], tiles[rendered]);
      ++rendered;
    }
  };
  std::size_t i = 0;
  for (; i + n <= count; i += n) {
    projectLanes(job, i, lanes);
    finish(i, n);
  }

  // The last few, from copies padded to a whole step.
  if (i < count) {
    const std::size_t rest = count - i;
    constexpr std::size_t kThree = 3 * kMaxLanes;
    alignas(64) float vectors[5][kThree] = {}, area[kMaxLanes] = {};
    PaperProjectJob padded = job;
    const auto pad = [&](const float*& from, float* to, std::size_t each) {
      if (!from) return;
      std::copy_n(from + each * i, each * rest, to);
      from = to;
    };
    pad(padded.position, vectors[0], 3);
    pad(padded.axis_u, vectors[1], 3);
    pad(padded.axis_v, vectors[2], 3);
    pad(padded.spread_u, vectors[3], 3);
    pad(padded.spread_v, vectors[4], 3);
    pad(padded.area, area, 1);
    projectLanes(padded, 0, lanes);
    finish(i, rest);
  }
  return rendered;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(projectPaperSurfels);

std::uint32_t projectPaper(const PaperSurfels& surfels, const View& view, const Defocus& defocus,
                           float shading, PaperSplat* splats, PaperSplatTiles* tiles) {
  const auto floats = [](const glm::vec3* v) { return v ? &v->x : nullptr; };
  PaperProjectJob job{};
  job.position = floats(surfels.position_m);
  job.axis_u = floats(surfels.axis_u_m);
  job.axis_v = floats(surfels.axis_v_m);
  job.spread_u = floats(surfels.spread_u_m);
  job.spread_v = floats(surfels.spread_v_m);
  job.color = floats(surfels.color);
  job.opacity = surfels.opacity;
  job.area = surfels.area_m2;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      job.rotation[3 * row + column] = view.eye_from_world[column][row];
    }
    job.translation[row] = view.eye_from_world[3][row];
  }
  job.focal_x = view.focal_px.x;
  job.focal_y = view.focal_px.y;
  job.principal_x = view.principal_px.x;
  job.principal_y = view.principal_px.y;
  job.width = static_cast<float>(view.size_px.x);
  job.height = static_cast<float>(view.size_px.y);
  job.near_m = view.near_m;
  job.blur_x = defocus.radius_px_per_D.x;
  job.blur_y = defocus.radius_px_per_D.y;
  job.blur_y_per_x = job.blur_x > 0.0f && job.blur_y > 0.0f ? job.blur_y / job.blur_x : 1.0f;
  job.focus_D = defocus.focus_D;
  job.j0 = defocus.astigmatism_D.x;
  job.j45 = defocus.astigmatism_D.y;
  job.astigmatic = isAstigmatic(defocus);
  job.along_axis = defocus.along == DistanceAlong::axis;
  job.shading = shading;
  const float rim = std::exp(-kPaperCutoff);
  job.rim_per_area = rim / (2.0f * std::numbers::pi_v<float> * (1.0f - rim));
  return HWY_DYNAMIC_DISPATCH(projectPaperSurfels)(job, surfels.count, splats, tiles);
}

}  // namespace foci
#endif  // HWY_ONCE
