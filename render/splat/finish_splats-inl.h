// Turns projected lanes into splats: the kernel, the key for binning with the distance of samples,
// the lens points, and the splat as a sub-aperture sees it. Included once a SIMD target.
#if defined(FOCI_FINISH_SPLATS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_FINISH_SPLATS_INL_H
#undef FOCI_FINISH_SPLATS_INL_H
#else
#define FOCI_FINISH_SPLATS_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/kernel/kernel.h"
#include "render/optics/defocus.h"
#include "render/splat/constants.h"
#include "render/splat/project_lanes-inl.h"
#include "render/splat/splat.h"

#ifndef FOCI_FINISH_SPLATS_ONCE
#define FOCI_FINISH_SPLATS_ONCE
namespace foci {

/// The factor on the kernels of closed bodies (`kFrontCover`). By the blur of the whole lens, so
/// that its parts and points see the same surface.
inline float frontCover(float blur_px2) { return 1.0f + kFrontCover / (1.0f + blur_px2); }

/// Where splats are written; all but the first two may be null.
struct SplatsOut {
  Splat* splats;
  SplatKey* keys;
  SplatLens* lens;
  SplatLens* lens_across;
  Splat* sub_aperture_splats;
  float* out_of_focus_D;
  float* out_across_D;
  glm::mat2* lens_px;
};

}  // namespace foci
#endif  // FOCI_FINISH_SPLATS_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// std::clamp without a branch, whose outcome would differ from splat to splat.
HWY_INLINE float between(float value, float low, float high) {
  return std::min(std::max(value, low), high);
}

/// A surfel's or a node's data besides its geometry.
struct Appearance {
  const float* color;  // linear RGB
  float opacity, weight;
  bool one_sided;           // the back of a closed body's surfel is hidden
  bool both_sides = false;  // counts as a front: the mean of its normals may face away
};

/// Sets the kernel of lane `k` (kernel.h) to the variance `widen` V + `blur` V_C, the prefilter not
/// widened. False if that variance is degenerate.
HWY_INLINE bool setKernel(const ProjectJob& job, const ProjectedLanes& lanes, std::size_t k,
                          float widen, float blur, float weight, Splat& splat) {
  const KernelShape& shape =
      kernelShape(job.shapes, kernelExponent(lanes.narrow[k] / std::max(blur, 1e-12f)));

  const float prefilter = lanes.prefilter[k];

  // Footprint x' R^-1 x < 1 with R = support2 W.
  const float rxx =
      shape.support2 * (prefilter + widen * (lanes.vxx[k] - prefilter) + blur * lanes.blur_x2[k]);
  const float ryy =
      shape.support2 * (prefilter + widen * (lanes.vyy[k] - prefilter) + blur * lanes.blur_y2[k]);
  const float rxy =
      shape.support2 * widen * lanes.vxy[k] + shape.support2 * blur * lanes.blur_xy[k];
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

/// Completes lane `k`. False if the kernel lies outside the image.
HWY_INLINE bool finishSplat(const ProjectJob& job, const ProjectedLanes& lanes, std::size_t k,
                            const Appearance& look, Splat& splat) {
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  if (!setKernel(job, lanes, k, 1.0f, 1.0f, look.weight, splat)) return false;
  if (!(splat.x_px + splat.extent_x_px > -job.margin &&
        splat.x_px - splat.extent_x_px < job.size.x + job.margin &&
        splat.y_px + splat.extent_y_px > -job.margin &&
        splat.y_px - splat.extent_y_px < job.size.y + job.margin)) {
    return false;
  }
  splat.opacity = look.opacity;
  const float scale = lanes.shade[k] * look.opacity;
  splat.red = scale * look.color[0];
  splat.green = scale * look.color[1];
  splat.blue = scale * look.color[2];
  if (job.oriented && lanes.away[k] > 0.0f && !look.both_sides) splat.opacity = -splat.opacity;
  splat.near_m = std::max(lanes.distance[k] - lanes.reach[k], 0.0f);
  splat.far_m = lanes.distance[k] + lanes.reach[k];
  return true;
}

/// Standard deviation that chooses the distance of samples (`SplatKey::sigma_px`).
///
/// A highlight's own shape is visible, while other splats show only as a sum, so a highlight needs
/// finer samples. The prefilter of acuity is smooth and allows coarser ones, as far as the
/// prefilter makes the shape.
HWY_INLINE float sigmaForSamples(const ProjectedLanes& lanes, std::size_t k, const Splat& splat) {
  const float brightest = std::max({splat.red, splat.green, splat.blue});
  const float peak = splat.k0 * brightest * between(brightest, 1.0f, kLight);
  const float highlight = between((peak - kHighlight) * (1.0f / kHighlight), 0.0f, 1.0f);
  const float all2 = lanes.prefilter[k] + lanes.blur_min2[k];
  const float by_acuity = (lanes.prefilter[k] - 1.0f) / all2;
  const float sharper = 1.0f - kFiner * highlight;
  return std::sqrt(all2) * (sharper + by_acuity * (kCoarser - sharper));
}

HWY_INLINE SplatKey keyOf(const ProjectJob& job, const ProjectedLanes& lanes, std::size_t k,
                          const Splat& splat) {
  const auto pixel = [](float px, float size_px) {
    return static_cast<std::uint16_t>(between(px, 0.0f, size_px - 1.0f));
  };
  return {.distance_m = lanes.distance[k],
          .sigma_px = sigmaForSamples(lanes, k, splat),
          .blur_px = lanes.radius[k],
          .x0 = pixel(splat.x_px - splat.extent_x_px - 0.5f, job.size.x),
          .x1 = pixel(splat.x_px + splat.extent_x_px - 0.5f, job.size.x),
          .y0 = pixel(splat.y_px - splat.extent_y_px - 0.5f, job.size.y),
          .y1 = pixel(splat.y_px + splat.extent_y_px - 0.5f, job.size.y)};
}

/// Writes the splat at `at` again, blurred by a sub-aperture, and its displacement a dioptre.
///
/// Few sub-apertures sample the lens coarsely. Where the sub-aperture's blur and the prefilter are
/// too narrow for neighbouring nodes to overlap, the splat is widened. The displacement is reduced
/// by the same variance, so that the total over all sub-apertures stays the blur's.
HWY_INLINE void finishSubAperture(const ProjectJob& job, const ProjectedLanes& lanes, std::size_t k,
                                  float weight, const SplatsOut& out, std::uint32_t at) {
  const float share = job.sub_aperture * job.sub_aperture;
  const float blur = lanes.blur_min2[k];
  const float overlap = kOverlap * lanes.added[k];  // variance that neighbours need to sum to one
  const float missing = std::max(overlap - share * blur - lanes.prefilter[k], 0.0f);
  const float own = 0.5f * (lanes.vxx[k] + lanes.vyy[k]) - lanes.prefilter[k];
  const float widen = missing > 0.0f ? 1.0f + missing / std::max(own, 1e-12f) : 1.0f;
  out.sub_aperture_splats[at] = out.splats[at];
  setKernel(job, lanes, k, widen, share, weight, out.sub_aperture_splats[at]);
  const auto spread = [&](float off_D, float variance) {
    const float rest = 1.0f - share - missing / std::max(variance, 1e-12f);
    return off_D * std::sqrt(std::max(rest, 0.0f));
  };
  if (out.lens_px) {
    const float rest = 1.0f - share - missing / std::max(blur, 1e-12f);
    out.lens_px[at] =
        std::sqrt(std::max(rest, 0.0f)) * glm::mat2(lanes.lens_px[0][k], lanes.lens_px[2][k],
                                                    lanes.lens_px[1][k], lanes.lens_px[3][k]);
    return;
  }
  const float off_D = lanes.out_of_focus_D[k];
  if (!out.lens_across) {
    out.out_of_focus_D[at] = spread(off_D, blur);
    return;
  }
  const float across_D = lanes.out_across_D[k];
  const float variance = kDiscVariancePerRadius2 * job.blur.x * job.blur.y;  // of one dioptre
  out.out_of_focus_D[at] = spread(off_D, variance * off_D * off_D);
  out.out_across_D[at] = spread(across_D, variance * across_D * across_D);
}

/// The lens points of lane `k` (`SplatLens`).
HWY_INLINE SplatLens lensOf(const ProjectedLanes& lanes, const LensScales& scales, std::size_t k) {
  return {scales.per_px[k], scales.inv_width[k], lanes.tilt_x[k], lanes.tilt_y[k]};
}

/// Writes the visible lanes to consecutive splats.
template <class AppearanceOf>
HWY_INLINE void finishLanes(const ProjectJob& job, const ProjectedLanes& lanes,
                            std::size_t lane_count, const AppearanceOf& appearanceOf,
                            const SplatsOut& out, std::uint32_t& count) {
  for (std::size_t k = 0; k < lane_count; ++k) {
    if (lanes.visible[k] == 0.0f) continue;
    Appearance look = appearanceOf(k);
    if (look.one_sided) {
      if (lanes.behind_m[k] > job.lens_m) continue;
      const float defocus_D = lanes.defocus_D[k];
      look.weight *= frontCover(job.lens_px_per_D * job.lens_px_per_D *
                                (defocus_D * defocus_D + glm::dot(job.j, job.j)));
    }
    if (!finishSplat(job, lanes, k, look, out.splats[count])) continue;
    out.keys[count] = keyOf(job, lanes, k, out.splats[count]);
    if (out.lens) out.lens[count] = lensOf(lanes, lanes.lens, k);
    if (out.lens_across) out.lens_across[count] = lensOf(lanes, lanes.lens_across, k);
    if (out.sub_aperture_splats) finishSubAperture(job, lanes, k, look.weight, out, count);
    ++count;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_FINISH_SPLATS_INL_H
