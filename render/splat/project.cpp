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

/// What the lanes need, flat. The frame's row r of the rotation is (r[3 row], r[3 row + 1], r[3 row
/// + 2]).
struct ProjectJob {
  const float* position;
  const float* axis_u;
  const float* axis_v;
  const float* color;
  const float* opacity;  // may be null
  const float* area;
  float rotation[9];
  float translation[3];
  float focal_x, focal_y, principal_x, principal_y;
  float width, height, near_m;
  float blur_x, blur_y, focus_D;  // radius in pixels a dioptre, of the part of the lens
  float lens_x, lens_y;           // its centre, likewise
  bool along_axis;
  bool disc;
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

/// Lanes of one step, as the scalar end reads them.
struct Lanes {
  static constexpr std::size_t kMost = 16;
  alignas(64) float x[kMost], y[kMost];
  alignas(64) float vxx[kMost], vxy[kMost], vyy[kMost];  // variance of the drawn splat, px^2
  alignas(64) float exponent[kMost];
  alignas(64) float area_px[kMost];
  alignas(64) float distance[kMost], reach[kMost];
  alignas(64) float shade[kMost],
      away[kMost];                   // cosine of the normal to the sight; > 0: away from the eye
  alignas(64) float visible[kMost];  // 1: keep
};

/// Surfels [i, i + N) to lanes.
HWY_INLINE void projectLanes(const ProjectJob& job, std::size_t i, Lanes& out) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const auto set = [&](float value) { return hn::Set(d, value); };

  // Into the eye frame.
  V3 p = rotate(d, job.rotation, load3(d, job.position + 3 * i));
  p = {hn::Add(p.x, set(job.translation[0])), hn::Add(p.y, set(job.translation[1])),
       hn::Add(p.z, set(job.translation[2]))};
  const V3 u = rotate(d, job.rotation, load3(d, job.axis_u + 3 * i));
  const V3 v = rotate(d, job.rotation, load3(d, job.axis_v + 3 * i));

  // Perspective and its Jacobian at the centre: x = c_x + f_x X / d, y = c_y - f_y Y / d, d = -Z.
  const V depth = hn::Neg(p.z);
  const auto before_near = hn::Lt(depth, set(job.near_m));
  const V inv_depth = hn::Div(one, hn::Max(depth, set(job.near_m)));
  const V tx = hn::Mul(p.x, inv_depth), ty = hn::Mul(p.y, inv_depth);
  V x_px = hn::MulAdd(set(job.focal_x), tx, set(job.principal_x));
  V y_px = hn::NegMulAdd(set(job.focal_y), ty, set(job.principal_y));
  const V sx = hn::Mul(set(job.focal_x), inv_depth), sy = hn::Mul(set(-job.focal_y), inv_depth);
  V ux = hn::Mul(sx, hn::MulAdd(u.z, tx, u.x)), uy = hn::Mul(sy, hn::MulAdd(u.z, ty, u.y));
  V vx = hn::Mul(sx, hn::MulAdd(v.z, tx, v.x)), vy = hn::Mul(sy, hn::MulAdd(v.z, ty, v.y));

  // Distance along the sight or the axis, and how the axes change it.
  const V distance = job.along_axis ? depth : hn::Sqrt(dot(p, p));
  const V inv_distance = hn::Div(one, distance);
  const V u_along = job.along_axis ? hn::Neg(u.z) : hn::Mul(dot(u, p), inv_distance);
  const V v_along = job.along_axis ? hn::Neg(v.z) : hn::Mul(dot(v, p), inv_distance);

  // Seen from the part's centre: the image moves with the vergence, and so does the Jacobian.
  const V out_of_focus_D = hn::Sub(set(job.focus_D), inv_distance);
  x_px = hn::MulAdd(set(job.lens_x), out_of_focus_D, x_px);
  y_px = hn::MulAdd(set(job.lens_y), out_of_focus_D, y_px);
  const V vergence_slope = hn::Mul(inv_distance, inv_distance);
  const V u_vergence = hn::Mul(u_along, vergence_slope),
          v_vergence = hn::Mul(v_along, vergence_slope);
  ux = hn::MulAdd(set(job.lens_x), u_vergence, ux);
  uy = hn::MulAdd(set(job.lens_y), u_vergence, uy);
  vx = hn::MulAdd(set(job.lens_x), v_vergence, vx);
  vy = hn::MulAdd(set(job.lens_y), v_vergence, vy);

  // Unblurred variance J V_r J' + I.
  V vxx = hn::MulAdd(ux, ux, hn::MulAdd(vx, vx, one));
  V vyy = hn::MulAdd(uy, uy, hn::MulAdd(vy, vy, one));
  const V vxy = hn::MulAdd(ux, uy, hn::Mul(vx, vy));

  // Projected area: area |det J| over the parallelogram of the axes.
  const V uu = dot(u, u), vv = dot(v, v);
  const V parallelogram = hn::Sqrt(hn::Mul(uu, vv));
  const V det_j = hn::Abs(hn::NegMulAdd(uy, vx, hn::Mul(ux, vy)));
  const V area_px = hn::Mul(hn::LoadU(d, job.area + i), hn::Div(det_j, parallelogram));

  // How far the unblurred splat reaches along the distance. A surfel counts as at least as thick as
  // it is wide: samples of one scanned surface scatter about it.
  const V slope = hn::MulAdd(u_along, u_along, hn::Mul(v_along, v_along));
  const V reach = hn::Sqrt(hn::MulAdd(set(kReach2), slope, hn::Max(uu, vv)));

  // Circle of confusion (Eq. 4 in dioptres).
  const V defocus_D = hn::Abs(out_of_focus_D);
  const V cx = hn::Mul(set(job.blur_x), defocus_D), cy = hn::Mul(set(job.blur_y), defocus_D);
  V exponent = set(kMaxExponent);
  V per_radius2 = set(kGaussianVariancePerRadius2);
  if (job.disc) {
    const V t = hn::Div(hn::Sqrt(hn::NegMulAdd(vxy, vxy, hn::Mul(vxx, vyy))),
                        hn::Max(hn::Mul(cx, cy), set(1e-12f)));
    exponent = hn::Mul(hn::Mul(set(24.0f), t), hn::MulAdd(set(2.0f), t, one));
    per_radius2 = set(0.25f);
  }
  vxx = hn::MulAdd(hn::Mul(per_radius2, cx), cx, vxx);
  vyy = hn::MulAdd(hn::Mul(per_radius2, cy), cy, vyy);

  // Lambert's cosine against the line of sight.
  const V3 normal{hn::NegMulAdd(u.z, v.y, hn::Mul(u.y, v.z)),
                  hn::NegMulAdd(u.x, v.z, hn::Mul(u.z, v.x)),
                  hn::NegMulAdd(u.y, v.x, hn::Mul(u.x, v.y))};
  const V away = hn::Div(dot(normal, p), hn::Mul(parallelogram, hn::Sqrt(dot(p, p))));
  const V shade = hn::MulAdd(set(job.shading), hn::Sub(hn::Abs(away), one), one);

  // Keep what draws something: in front, on the image, with an area. Comparisons fail on NaN.
  const V radius_x = hn::Sqrt(hn::Mul(set(kWidestSupport2), vxx));
  const V radius_y = hn::Sqrt(hn::Mul(set(kWidestSupport2), vyy));
  auto keep = hn::And(hn::Gt(hn::Add(x_px, radius_x), set(0.0f)),
                      hn::Lt(hn::Sub(x_px, radius_x), set(job.width)));
  keep = hn::And(keep, hn::And(hn::Gt(hn::Add(y_px, radius_y), set(0.0f)),
                               hn::Lt(hn::Sub(y_px, radius_y), set(job.height))));
  keep = hn::And(keep, hn::And(hn::Gt(area_px, set(0.0f)), hn::Lt(area_px, set(kLargest_px2))));
  keep = hn::And(keep, hn::And(hn::Lt(vxx, set(kLargest_px2)), hn::Lt(vyy, set(kLargest_px2))));
  keep = hn::AndNot(before_near, keep);

  hn::Store(x_px, d, out.x);
  hn::Store(y_px, d, out.y);
  hn::Store(vxx, d, out.vxx);
  hn::Store(vxy, d, out.vxy);
  hn::Store(vyy, d, out.vyy);
  hn::Store(exponent, d, out.exponent);
  hn::Store(area_px, d, out.area_px);
  hn::Store(distance, d, out.distance);
  hn::Store(reach, d, out.reach);
  hn::Store(shade, d, out.shade);
  hn::Store(away, d, out.away);
  hn::Store(hn::IfThenElseZero(keep, one), d, out.visible);
}

/// Completes lane `k`, surfel `i`. False where it turns out to lie outside the image.
HWY_INLINE bool finishSplat(const ProjectJob& job, const Lanes& lanes, std::size_t k, std::size_t i,
                            Splat& splat, SplatKey& key) {
  const KernelShape& shape = kernelShape(lanes.exponent[k]);

  // Footprint x' R^-1 x < 1 with R = support2 V.
  const float rxx = shape.support2 * lanes.vxx[k];
  const float rxy = shape.support2 * lanes.vxy[k];
  const float ryy = shape.support2 * lanes.vyy[k];
  splat.extent_x_px = std::sqrt(rxx);
  splat.extent_y_px = std::sqrt(ryy);
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  if (!(splat.x_px + splat.extent_x_px > 0.0f && splat.x_px - splat.extent_x_px < job.width &&
        splat.y_px + splat.extent_y_px > 0.0f && splat.y_px - splat.extent_y_px < job.height)) {
    return false;
  }
  const float det = rxx * ryy - rxy * rxy;
  if (!(det > 0.0f)) return false;
  const float inv_det = 1.0f / det;
  splat.qa = ryy * inv_det;
  splat.qb = -2.0f * rxy * inv_det;
  splat.qc = rxx * inv_det;
  const float height = lanes.area_px[k] * std::sqrt(inv_det);
  splat.k0 = shape.k0 * height;
  splat.k1 = shape.k1 * height;
  splat.k2 = shape.k2 * height;

  splat.opacity = job.opacity ? job.opacity[i] : 1.0f;
  const float scale = lanes.shade[k] * splat.opacity;
  splat.red = scale * job.color[3 * i];
  splat.green = scale * job.color[3 * i + 1];
  splat.blue = scale * job.color[3 * i + 2];
  if (job.oriented && lanes.away[k] > kFromBehind) splat.opacity = -splat.opacity;
  splat.near_m = std::max(lanes.distance[k] - lanes.reach[k], 0.0f);
  splat.far_m = lanes.distance[k] + lanes.reach[k];

  // Tiles whose pixel centres the footprint's box may reach.
  const auto tile = [](float px, float size_px) {
    return static_cast<std::uint16_t>(std::clamp(px, 0.0f, size_px - 1.0f) * (1.0f / kTile_px));
  };
  key = {.near_m = splat.near_m,
         .x0 = tile(splat.x_px - splat.extent_x_px - 0.5f, job.width),
         .x1 = tile(splat.x_px + splat.extent_x_px - 0.5f, job.width),
         .y0 = tile(splat.y_px - splat.extent_y_px - 0.5f, job.height),
         .y1 = tile(splat.y_px + splat.extent_y_px - 0.5f, job.height)};
  return true;
}

/// Projects [begin, end) to consecutive splats; returns their number.
std::uint32_t projectRange(const ProjectJob& job, std::size_t begin, std::size_t end, Splat* splats,
                           SplatKey* keys) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  std::uint32_t count = 0;
  Lanes lanes;
  std::size_t i = begin;
  for (; i + n <= end; i += n) {
    projectLanes(job, i, lanes);
    for (std::size_t k = 0; k < n; ++k) {
      const bool drawn =
          lanes.visible[k] != 0.0f && finishSplat(job, lanes, k, i + k, splats[count], keys[count]);
      count += drawn;
    }
  }

  // The last few, from copies padded to a whole step.
  if (i < end) {
    const std::size_t rest = end - i;
    alignas(64) float position[48] = {}, axis_u[48] = {}, axis_v[48] = {}, area[16] = {};
    std::copy_n(job.position + 3 * i, 3 * rest, position);
    std::copy_n(job.axis_u + 3 * i, 3 * rest, axis_u);
    std::copy_n(job.axis_v + 3 * i, 3 * rest, axis_v);
    std::copy_n(job.area + i, rest, area);
    ProjectJob padded = job;
    padded.position = position;
    padded.axis_u = axis_u;
    padded.axis_v = axis_v;
    padded.area = area;
    projectLanes(padded, 0, lanes);
    for (std::size_t k = 0; k < rest; ++k) {
      const bool drawn =
          lanes.visible[k] != 0.0f && finishSplat(job, lanes, k, i + k, splats[count], keys[count]);
      count += drawn;
    }
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(projectRange);

void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks) {
  ProjectJob job{};
  job.position = cloud.empty() ? nullptr : &cloud.position_m[0].x;
  job.axis_u = cloud.empty() ? nullptr : &cloud.axis_u_m[0].x;
  job.axis_v = cloud.empty() ? nullptr : &cloud.axis_v_m[0].x;
  job.color = cloud.empty() ? nullptr : &cloud.color[0].x;
  job.opacity = cloud.opacity.empty() ? nullptr : cloud.opacity.data();
  job.area = cloud.area_m2.data();
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
  job.blur_x = defocus.radius_px_per_D.x * projection.aperture;
  job.blur_y = defocus.radius_px_per_D.y * projection.aperture;
  job.lens_x = defocus.radius_px_per_D.x * projection.lens.x;
  job.lens_y = defocus.radius_px_per_D.y * projection.lens.y;
  job.focus_D = defocus.focus_D;
  job.along_axis = defocus.along == DistanceAlong::axis;
  job.disc = projection.kernel == BlurKernel::disc;
  job.oriented = cloud.oriented;
  job.shading = projection.shading;

  // Whole steps a chunk, about as many chunks as the largest machine has threads.
  constexpr std::size_t kMostChunks = 64, kStep = 4096;
  const std::size_t n = cloud.size();
  chunks.chunk_size = std::max(kStep, (n / kMostChunks + kStep) / kStep * kStep);
  chunks.count.assign((n + chunks.chunk_size - 1) / chunks.chunk_size, 0);
  if (chunks.capacity < n) {
    chunks.splats.reset();
    chunks.keys.reset();
    chunks.splats = std::make_unique_for_overwrite<Splat[]>(n);
    chunks.keys = std::make_unique_for_overwrite<SplatKey[]>(n);
    chunks.capacity = n;
  }
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    const std::size_t begin = c * chunks.chunk_size;
    const std::size_t end = std::min(n, begin + chunks.chunk_size);
    chunks.count[c] = HWY_DYNAMIC_DISPATCH(projectRange)(
        job, begin, end, chunks.splats.get() + begin, chunks.keys.get() + begin);
  });
}

}  // namespace foci
#endif  // HWY_ONCE
