// EWA splatting with the blur of each splat (Krivanek, Zara and Bouatouch 2003, Eq. 5 to 12), a
// SIMD step at a time.
#include "render/literature/paper/project.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/literature/paper/circumellipse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/literature/paper/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include "render/kernel/simd-inl.h"

#ifndef FOCI_PAPER_PROJECT_ONCE
#define FOCI_PAPER_PROJECT_ONCE
namespace foci {

/// Larger splats are dropped: a variance or an area of 10^5 by 10^5 pixels is beyond any use.
inline constexpr float kLargestPaperSplat_px2 = 1e10f;

/// Half of a z-range is at least this share of the depth. It covers the rounding of coordinates:
/// without it, the splats of a plane that faces the eye would not merge.
inline constexpr float kMinRangePerDepth = 1e-5f;

struct PaperProjectJob {
  PaperSurfels surfels;
  const View& view;
  const Defocus& defocus;
  float blur_y_per_x;
  const Lighting& lighting;
  float rim_per_area;  // height at the rim of a truncated Gaussian of area 1 and determinant 1
};

}  // namespace foci
#endif  // FOCI_PAPER_PROJECT_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace {

/// A symmetric 2x2 matrix in each lane, px^2.
struct Variances {
  V xx, xy, yy;
};

HWY_INLINE V set(float value) { return hn::Set(D(), value); }

/// From the world's directions to the eye's.
HWY_INLINE V3 rotate(const View& view, const V3& p) {
  const glm::mat4& m = view.eye_from_world;
  const auto row = [&](int i) {
    return hn::MulAdd(set(m[0][i]), p.x, hn::MulAdd(set(m[1][i]), p.y, hn::Mul(set(m[2][i]), p.z)));
  };
  return {row(0), row(1), row(2)};
}

/// The affine map J from the eye frame to the image around one point.
struct Jacobian {
  V sx, sy, tx, ty;
  HWY_INLINE V x(const V3& a) const { return hn::Mul(sx, hn::MulAdd(a.z, tx, a.x)); }
  HWY_INLINE V y(const V3& a) const { return hn::Mul(sy, hn::MulAdd(a.z, ty, a.y)); }
};

inline constexpr std::size_t kMaxLanes = 16;

/// Results of one step, for the scalar code that follows.
struct Lanes {
  alignas(64) float x[kMaxLanes], y[kMaxLanes];
  alignas(64) float wxx[kMaxLanes], wxy[kMaxLanes], wyy[kMaxLanes], det[kMaxLanes];  // of W
  alignas(64) float area_px[kMaxLanes];
  alignas(64) float distance[kMaxLanes], near_m[kMaxLanes], far_m[kMaxLanes];
  alignas(64) float shade[kMaxLanes];
  alignas(64) float visible[kMaxLanes];  // 1: keep
};

/// The surfels of one step in the eye frame.
struct EyeSurfels {
  V3 p, u, v;
  V depth;
  V3 normal;        // u x v, not normalised
  V parallelogram;  // |u x v|
};

HWY_INLINE EyeSurfels toEye(const PaperProjectJob& job, std::size_t i) {
  V3 p = rotate(job.view, load3(&job.surfels.position_m[i].x));
  p = {hn::Add(p.x, set(job.view.eye_from_world[3][0])),
       hn::Add(p.y, set(job.view.eye_from_world[3][1])),
       hn::Add(p.z, set(job.view.eye_from_world[3][2]))};
  const V3 u = rotate(job.view, load3(&job.surfels.axis_u_m[i].x));
  const V3 v = rotate(job.view, load3(&job.surfels.axis_v_m[i].x));
  const V3 normal = cross(u, v);
  return {p, u, v, hn::Neg(p.z), normal, hn::Sqrt(dot(normal, normal))};
}

/// Perspective at the centre: x = c_x + f_x X / z, y = c_y - f_y Y / z, with z = -Z. Its
/// derivatives are J.
HWY_INLINE Jacobian jacobianAt(const PaperProjectJob& job, const EyeSurfels& surfel) {
  const V inv_depth = hn::Div(set(1.0f), hn::Max(surfel.depth, set(job.view.near_m)));
  return {hn::Mul(set(job.view.focal_px.x), inv_depth),
          hn::Mul(set(-job.view.focal_px.y), inv_depth), hn::Mul(surfel.p.x, inv_depth),
          hn::Mul(surfel.p.y, inv_depth)};
}

/// Variance on the image of the axes whose projections are (ux, uy) and (vx, vy).
HWY_INLINE Variances varianceOf(V ux, V uy, V vx, V vy) {
  return {hn::MulAdd(ux, ux, hn::Mul(vx, vx)), hn::MulAdd(ux, uy, hn::Mul(vx, vy)),
          hn::MulAdd(uy, uy, hn::Mul(vy, vy))};
}

/// The blur of one step.
struct Blur {
  V cx, cy;            // radius of the circle of confusion, px; of an ellipse, half its box
  Variances variance;  // V_C
};

/// V_C (Eq. 4 in dioptres, and Eq. 11).
HWY_INLINE Blur blurAt(const PaperProjectJob& job, V distance) {
  const D d;
  const V scale = set(kGaussianVariancePerRadius2);
  const V out_of_focus_D = hn::Sub(set(job.defocus.focus_D), hn::Div(set(1.0f), distance));
  V cx, cy, xy;
  if (isAstigmatic(job.defocus)) {
    const V j45 = set(job.defocus.astigmatism_D.y),
            fx = hn::Add(out_of_focus_D, set(job.defocus.astigmatism_D.x));
    const V fy = hn::Sub(out_of_focus_D, set(job.defocus.astigmatism_D.x));
    cx = hn::Mul(set(job.defocus.radius_px_per_D.x),
                 hn::Sqrt(hn::MulAdd(fx, fx, hn::Mul(j45, j45))));
    cy = hn::Mul(set(job.defocus.radius_px_per_D.y),
                 hn::Sqrt(hn::MulAdd(fy, fy, hn::Mul(j45, j45))));
    xy = hn::Mul(set(2.0f * kGaussianVariancePerRadius2 * job.defocus.radius_px_per_D.x *
                     job.defocus.radius_px_per_D.y * job.defocus.astigmatism_D.y),
                 out_of_focus_D);
  } else {
    const V defocus_D = hn::Abs(out_of_focus_D);
    cx = hn::Mul(set(job.defocus.radius_px_per_D.x), defocus_D);
    cy = hn::Mul(set(job.defocus.radius_px_per_D.y), defocus_D);
    xy = hn::Zero(d);
  }
  return {cx, cy, {hn::Mul(hn::Mul(scale, cx), cx), xy, hn::Mul(hn::Mul(scale, cy), cy)}};
}

/// circumellipse(B, V_C). Of a round lens, V_C = a diag(C_x^2, C_y^2): where y is scaled by
/// C_x / C_y, V_C is a circle.
HWY_INLINE Variances circumellipseLanes(const PaperProjectJob& job, const Variances& b,
                                        const Variances& c) {
  const D d;
  alignas(64) float of_b[3][kMaxLanes], of_c[3][kMaxLanes];
  hn::Store(b.xx, d, of_b[0]);
  hn::Store(b.xy, d, of_b[1]);
  hn::Store(b.yy, d, of_b[2]);
  hn::Store(c.xx, d, of_c[0]);
  hn::Store(c.xy, d, of_c[1]);
  hn::Store(c.yy, d, of_c[2]);
  const bool round = !isAstigmatic(job.defocus);
  const float y_per_x = round ? job.blur_y_per_x : 1.0f, x_per_y = 1.0f / y_per_x;
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    const Variance scaled{of_b[0][k], of_b[1][k] * x_per_y, of_b[2][k] * x_per_y * x_per_y};
    const Variance w = round ? circumellipse(scaled, of_c[0][k])
                             : circumellipse(scaled, {of_c[0][k], of_c[1][k], of_c[2][k]});
    of_b[0][k] = w.xx;
    of_b[1][k] = w.xy * y_per_x;
    of_b[2][k] = w.yy * y_per_x * y_per_x;
  }
  return {hn::Load(d, of_b[0]), hn::Load(d, of_b[1]), hn::Load(d, of_b[2])};
}

/// The low-pass filter V_l of a node, on the image and along the depth.
struct LowPass {
  Variances covering;  // circumellipse(J V_l J', V_C); without a filter V_C
  V along_depth_m2;
};

HWY_INLINE LowPass lowPassOf(const PaperProjectJob& job, std::size_t i, const Jacobian& jacobian,
                             const Variances& blur) {
  if (!job.surfels.spread_u_m) return {blur, hn::Zero(D())};
  const V3 u = rotate(job.view, load3(&job.surfels.spread_u_m[i].x));
  const V3 v = rotate(job.view, load3(&job.surfels.spread_v_m[i].x));
  const Variances filter = varianceOf(jacobian.x(u), jacobian.y(u), jacobian.x(v), jacobian.y(v));
  return {circumellipseLanes(job, filter, blur), hn::MulAdd(u.z, u.z, hn::Mul(v.z, v.z))};
}

/// Half of the z-range. Across the plane the depth changes by the sine of the plane's tilt times
/// the distance on the plane. Blur and prefilter, brought back from the image to the surfel, widen
/// the basis function equally in all directions.
HWY_INLINE V halfRangeOf(const PaperProjectJob& job, const EyeSurfels& surfel, const Blur& blur,
                         V low_pass_m2) {
  const V3& u = surfel.u;
  const V3& v = surfel.v;
  const V sin2 = hn::Div(
      hn::MulAdd(surfel.normal.x, surfel.normal.x, hn::Mul(surfel.normal.y, surfel.normal.y)),
      hn::Mul(surfel.parallelogram, surfel.parallelogram));
  const V unit_x = hn::Mul(surfel.depth, set(1.0f / job.view.focal_px.x));
  const V unit_y = hn::Mul(surfel.depth, set(1.0f / job.view.focal_px.y));
  const V pixel2 = hn::Mul(hn::Max(hn::Mul(unit_x, unit_x), hn::Mul(unit_y, unit_y)), sin2);
  const V blur_m = hn::Max(hn::Mul(unit_x, blur.cx), hn::Mul(unit_y, blur.cy));
  const V blur2 = hn::Mul(hn::Mul(set(kGaussianVariancePerRadius2), hn::Mul(blur_m, blur_m)), sin2);
  const V along2 = hn::Add(hn::MulAdd(u.z, u.z, hn::Mul(v.z, v.z)),
                           hn::Add(pixel2, hn::Max(low_pass_m2, blur2)));
  const V min_m = hn::Mul(set(kMinRangePerDepth), surfel.depth);
  return hn::Sqrt(hn::MulAdd(set(2.0f * kPaperCutoff), along2, hn::Mul(min_m, min_m)));
}

/// Whether the footprint of variance W around (x, y) touches the image and has a usable size.
/// Comparisons fail on NaN.
HWY_INLINE M touchesImage(const PaperProjectJob& job, V x, V y, const Variances& w, V det,
                          V area_px) {
  const V radius_x = hn::Sqrt(hn::Mul(set(2.0f * kPaperCutoff), w.xx));
  const V radius_y = hn::Sqrt(hn::Mul(set(2.0f * kPaperCutoff), w.yy));
  M keep = hn::And(hn::Gt(hn::Add(x, radius_x), set(0.0f)),
                   hn::Lt(hn::Sub(x, radius_x), set(static_cast<float>(job.view.size_px.x))));
  keep = hn::And(
      keep, hn::And(hn::Gt(hn::Add(y, radius_y), set(0.0f)),
                    hn::Lt(hn::Sub(y, radius_y), set(static_cast<float>(job.view.size_px.y)))));
  const V largest = set(kLargestPaperSplat_px2);
  keep = hn::And(keep, hn::And(hn::Gt(area_px, set(0.0f)), hn::Lt(area_px, largest)));
  keep = hn::And(keep, hn::And(hn::Lt(w.xx, largest), hn::Lt(w.yy, largest)));
  return hn::And(keep, hn::Gt(det, set(0.0f)));
}

/// Projects the surfels [i, i + N) of the job.
HWY_INLINE void projectLanes(const PaperProjectJob& job, std::size_t i, Lanes& out) {
  const D d;
  const V one = set(1.0f);

  // Centre and unblurred variance J V_r J'.
  const EyeSurfels surfel = toEye(job, i);
  const Jacobian jacobian = jacobianAt(job, surfel);
  const V x_px = hn::MulAdd(set(job.view.focal_px.x), jacobian.tx, set(job.view.principal_px.x));
  const V y_px = hn::NegMulAdd(set(job.view.focal_px.y), jacobian.ty, set(job.view.principal_px.y));
  const V ux = jacobian.x(surfel.u), uy = jacobian.y(surfel.u);
  const V vx = jacobian.x(surfel.v), vy = jacobian.y(surfel.v);
  const Variances r = varianceOf(ux, uy, vx, vy);

  // K: the prefilter I, and V_C or the ellipse about V_C and the low-pass filter.
  const V distance =
      job.defocus.along == DistanceAlong::axis ? surfel.depth : hn::Sqrt(dot(surfel.p, surfel.p));
  const Blur blur = blurAt(job, distance);
  const LowPass low_pass = lowPassOf(job, i, jacobian, blur.variance);
  const Variances k{hn::Add(low_pass.covering.xx, one), low_pass.covering.xy,
                    hn::Add(low_pass.covering.yy, one)};

  // W = J V_r J' + K. W may be long and thin, so its determinant is a sum of terms that do not
  // cancel.
  const Variances w{hn::Add(r.xx, k.xx), hn::Add(r.xy, k.xy), hn::Add(r.yy, k.yy)};
  const V det_j = hn::NegMulAdd(uy, vx, hn::Mul(ux, vy));
  const V mixed =
      hn::NegMulAdd(hn::Add(r.xy, r.xy), k.xy, hn::MulAdd(r.xx, k.yy, hn::Mul(r.yy, k.xx)));
  const V det =
      hn::Add(hn::MulAdd(det_j, det_j, mixed), hn::NegMulAdd(k.xy, k.xy, hn::Mul(k.xx, k.yy)));

  // Projected area: area |det J| over the parallelogram of the axes.
  const V area_px =
      hn::Mul(hn::LoadU(d, job.surfels.area_m2 + i), hn::Div(hn::Abs(det_j), surfel.parallelogram));

  const V half_range = halfRangeOf(job, surfel, blur, low_pass.along_depth_m2);
  const V near_m = hn::Sub(surfel.depth, half_range), far_m = hn::Add(surfel.depth, half_range);

  // Lambert's cosine between the normal and the line of sight.
  const V cosine = hn::Div(hn::Abs(dot(surfel.normal, surfel.p)),
                           hn::Mul(surfel.parallelogram, hn::Sqrt(dot(surfel.p, surfel.p))));
  const V shade = hn::MulAdd(set(job.lighting.shading), hn::Sub(cosine, one), one);

  M keep = hn::And(touchesImage(job, x_px, y_px, w, det, area_px), hn::Le(near_m, far_m));
  keep = hn::AndNot(hn::Lt(surfel.depth, set(job.view.near_m)), keep);

  hn::Store(x_px, d, out.x);
  hn::Store(y_px, d, out.y);
  hn::Store(w.xx, d, out.wxx);
  hn::Store(w.xy, d, out.wxy);
  hn::Store(w.yy, d, out.wyy);
  hn::Store(det, d, out.det);
  hn::Store(area_px, d, out.area_px);
  hn::Store(distance, d, out.distance);
  hn::Store(near_m, d, out.near_m);
  hn::Store(far_m, d, out.far_m);
  hn::Store(shade, d, out.shade);
  hn::Store(hn::IfThenElseZero(keep, one), d, out.visible);
}

/// Makes the splat of lane `k`, which holds surfel `i`.
HWY_INLINE void finishSplat(const PaperProjectJob& job, const Lanes& lanes, std::size_t k,
                            std::size_t i, PaperSplat& splat, PaperSplatTiles& tiles) {
  const float half_inv_det = 0.5f / lanes.det[k];
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  splat.qa = lanes.wyy[k] * half_inv_det;
  splat.qb = -2.0f * lanes.wxy[k] * half_inv_det;
  splat.qc = lanes.wxx[k] * half_inv_det;
  splat.height = job.rim_per_area * lanes.area_px[k] / std::sqrt(lanes.det[k]);
  splat.opacity = job.surfels.opacity ? job.surfels.opacity[i] : 1.0f;
  const float scale = lanes.shade[k] * splat.opacity;
  splat.red = scale * job.surfels.color[i].r;
  splat.green = scale * job.surfels.color[i].g;
  splat.blue = scale * job.surfels.color[i].b;
  splat.near_m = lanes.near_m[k];
  splat.far_m = lanes.far_m[k];
  splat.distance_m = lanes.distance[k];
  splat.extent_x_px = std::sqrt(2.0f * kPaperCutoff * lanes.wxx[k]);
  splat.extent_y_px = std::sqrt(2.0f * kPaperCutoff * lanes.wyy[k]);

  // Tiles that hold pixel centres inside the footprint's box.
  const auto tile = [](float px, int size_px) {
    return static_cast<std::uint16_t>(std::clamp(px, 0.0f, static_cast<float>(size_px) - 1.0f) *
                                      (1.0f / kPaperTile_px));
  };
  tiles = {.x0 = tile(splat.x_px - splat.extent_x_px - 0.5f, job.view.size_px.x),
           .x1 = tile(splat.x_px + splat.extent_x_px - 0.5f, job.view.size_px.x),
           .y0 = tile(splat.y_px - splat.extent_y_px - 0.5f, job.view.size_px.y),
           .y1 = tile(splat.y_px + splat.extent_y_px - 0.5f, job.view.size_px.y)};
}

}  // namespace

std::uint32_t projectPaperSurfels(const PaperProjectJob& job, PaperSplat* splats,
                                  PaperSplatTiles* tiles) {
  const D d;
  const std::size_t n = hn::Lanes(d), count = job.surfels.count;
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

  // The last surfels go through copies that are padded to a full step.
  if (i < count) {
    const std::size_t rest = count - i;
    glm::vec3 vectors[5][kMaxLanes] = {};
    float area[kMaxLanes] = {};
    PaperProjectJob padded = job;
    const auto pad = [&](auto*& from, auto* to) {
      if (!from) return;
      std::copy_n(from + i, rest, to);
      from = to;
    };
    pad(padded.surfels.position_m, vectors[0]);
    pad(padded.surfels.axis_u_m, vectors[1]);
    pad(padded.surfels.axis_v_m, vectors[2]);
    pad(padded.surfels.spread_u_m, vectors[3]);
    pad(padded.surfels.spread_v_m, vectors[4]);
    pad(padded.surfels.area_m2, area);
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
                           const Lighting& lighting, PaperSplat* splats, PaperSplatTiles* tiles) {
  const glm::vec2 blur = defocus.radius_px_per_D;
  const float rim = std::exp(-kPaperCutoff);
  return HWY_DYNAMIC_DISPATCH(projectPaperSurfels)(
      {.surfels = surfels,
       .view = view,
       .defocus = defocus,
       .blur_y_per_x = blur.x > 0.0f && blur.y > 0.0f ? blur.y / blur.x : 1.0f,
       .lighting = lighting,
       .rim_per_area = rim / (2.0f * std::numbers::pi_v<float> * (1.0f - rim))},
      splats, tiles);
}

}  // namespace foci
#endif  // HWY_ONCE
