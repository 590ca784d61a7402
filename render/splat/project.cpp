#include "render/splat/project.h"

#include <hwy/cache_control.h>

#include "base/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "render/kernel/kernel.h"
#include "render/kernel/limits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include "render/splat/project_lanes-inl.h"

#ifndef FOCI_PROJECT_ONCE
#define FOCI_PROJECT_ONCE
namespace foci {

/// Light of a single splat at its centre from which, and at twice that most, it counts as sharper.
inline constexpr float kHighlight = 0.06f, kFiner = 0.6f;

/// What acuity softens stands so much coarser samples: what they get wrong is finer than is seen.
inline constexpr float kCoarser = 1.4f;

/// Where splats go; all but the first two may be null.
struct SplatsOut {
  Splat* splats;
  SplatKey* keys;
  SplatLens* lens;
  SplatLens* lens_across;
  Splat* parts;
  float* out_of_focus_D;
  float* out_across_D;
};

}  // namespace foci
#endif  // FOCI_PROJECT_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
/// What a surfel or node brings along besides its geometry.
struct Paint {
  const float* color;
  float opacity, weight;
};

/// The kernel of lane `k` with variance `widen` V + `blur` V_C (kernel.h). False where it has none.
HWY_INLINE bool setKernel(const Lanes& lanes, std::size_t k, float widen, float blur, float weight,
                          Splat& splat) {
  const KernelShape& shape = kernelShape(kernelExponent(lanes.narrow[k] / std::max(blur, 1e-12f)));

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

/// Completes lane `k`. False where it turns out to lie outside the image.
HWY_INLINE bool finishSplat(const ProjectJob& job, const Lanes& lanes, std::size_t k,
                            const Paint& render, Splat& splat, SplatKey& key) {
  splat.x_px = lanes.x[k];
  splat.y_px = lanes.y[k];
  if (!setKernel(lanes, k, 1.0f, 1.0f, render.weight, splat)) return false;
  if (!(splat.x_px + splat.extent_x_px > -job.margin &&
        splat.x_px - splat.extent_x_px < job.width + job.margin &&
        splat.y_px + splat.extent_y_px > -job.margin &&
        splat.y_px - splat.extent_y_px < job.height + job.margin)) {
    return false;
  }
  splat.opacity = render.opacity;
  const float scale = lanes.shade[k] * render.opacity;
  splat.red = scale * render.color[0];
  splat.green = scale * render.color[1];
  splat.blue = scale * render.color[2];
  if (job.oriented && lanes.away[k] > kBackFacing) splat.opacity = -splat.opacity;
  splat.near_m = std::max(lanes.distance[k] - lanes.reach[k], 0.0f);
  splat.far_m = lanes.distance[k] + lanes.reach[k];

  // Pixels whose centres the footprint's box may reach.
  const auto pixel = [](float px, float size_px) {
    return static_cast<std::uint16_t>(std::clamp(px, 0.0f, size_px - 1.0f));
  };
  // A highlight's own shape shows, others' only in sum: it wants finer samples. Both as far as the
  // lens makes the shape, not acuity, whose Gaussian is smooth.
  const float peak =
      (splat.k0 + splat.k1 + splat.k2) * std::max({splat.red, splat.green, splat.blue});
  const float highlight = std::clamp((peak - kHighlight) / kHighlight, 0.0f, 1.0f);
  const float all2 = lanes.prefilter[k] + lanes.blur_least2[k];
  const float by_acuity = (lanes.prefilter[k] - 1.0f) / all2;
  const float sharper = 1.0f - kFiner * highlight;
  key = {.distance_m = lanes.distance[k],
         .sigma_px = std::sqrt(all2) * (sharper + by_acuity * (kCoarser - sharper)),
         .blur_px = lanes.radius[k],
         .x0 = pixel(splat.x_px - splat.extent_x_px - 0.5f, job.width),
         .x1 = pixel(splat.x_px + splat.extent_x_px - 0.5f, job.width),
         .y0 = pixel(splat.y_px - splat.extent_y_px - 0.5f, job.height),
         .y1 = pixel(splat.y_px + splat.extent_y_px - 0.5f, job.height)};
  return true;
}

/// The same splat, blurred by a part of the lens only. Parts are few where nodes are coarse: then
/// it is widened, where prefilter and blur do not suffice, so that neighbours still overlap, and
/// what the blur has of that already is not spread over the lens.
HWY_INLINE void finishPart(const ProjectJob& job, const Lanes& lanes, std::size_t k, float weight,
                           const SplatsOut& out, std::uint32_t at) {
  const float share = job.part_aperture * job.part_aperture;
  const float blur = lanes.blur_least2[k];
  const float overlap = kOverlap * lanes.added[k];  // variance, what neighbours need to be one
  const float wanting = std::max(overlap - share * blur - lanes.prefilter[k], 0.0f);
  const float own = 0.5f * (lanes.vxx[k] + lanes.vyy[k]) - lanes.prefilter[k];
  const float widen = wanting > 0.0f ? 1.0f + wanting / std::max(own, 1e-12f) : 1.0f;
  out.parts[at] = out.splats[at];
  setKernel(lanes, k, widen, share, weight, out.parts[at]);
  const auto spread = [&](float off_D, float variance) {
    const float rest = 1.0f - share - wanting / std::max(variance, 1e-12f);
    return off_D * std::sqrt(std::max(rest, 0.0f));
  };
  const float off_D = lanes.out_of_focus_D[k];
  if (!out.lens_across) {
    out.out_of_focus_D[at] = spread(off_D, blur);
    return;
  }
  const float across_D = lanes.out_across_D[k];
  const float variance = kDiscVariancePerRadius2 * job.blur_x * job.blur_y;  // of a dioptre
  out.out_of_focus_D[at] = spread(off_D, variance * off_D * off_D);
  out.out_across_D[at] = spread(across_D, variance * across_D * across_D);
}

/// The lanes that render something, to consecutive splats.
template <class PaintOf>
HWY_INLINE void finishLanes(const ProjectJob& job, const Lanes& lanes, std::size_t lane_count,
                            const PaintOf& paintOf, const SplatsOut& out, std::uint32_t& count) {
  for (std::size_t k = 0; k < lane_count; ++k) {
    if (lanes.visible[k] == 0.0f) continue;
    const Paint render = paintOf(k);
    if (!finishSplat(job, lanes, k, render, out.splats[count], out.keys[count])) continue;
    if (out.lens_across) {
      out.lens[count] = lensAlong(job, lanes, k, lanes.out_of_focus_D[k]);
      out.lens_across[count] = lensAlong(job, lanes, k, lanes.out_across_D[k]);
    } else if (out.lens) {
      out.lens[count] = lensOf(lanes, k);
    }
    if (out.parts) finishPart(job, lanes, k, render.weight, out, count);
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
      if (e + n + k < entry_count) hwy::Prefetch(&nodes[entries[e + n + k].index]);
      const LodNode& node = nodes[entries[e + k].index];
      for (int axis = 0; axis < 3; ++axis) arrays.position[axis][k] = node.position_m[axis];
      for (int axis = 0; axis < 2; ++axis) arrays.normal[axis][k] = node.normal[axis];
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

bool blurs(const ProjectJob& job) { return job.blur_x > 0.0f && job.blur_y > 0.0f; }

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
  // What astigmatism moves a point aside by, seen from a part of the lens, is the same everywhere.
  const glm::vec2 part = projection.lens, j = defocus.astigmatism_D;
  const glm::vec2 aside_D(j.x * part.x + j.y * part.y, j.y * part.x - j.x * part.y);
  job.principal_x = view.principal_px.x + defocus.radius_px_per_D.x * aside_D.x;
  job.principal_y = view.principal_px.y + defocus.radius_px_per_D.y * aside_D.y;
  job.width = static_cast<float>(view.size_px.x);
  job.height = static_cast<float>(view.size_px.y);
  job.near_m = view.near_m;
  job.margin = static_cast<float>(projection.margin_px);
  job.blur_x = defocus.radius_px_per_D.x * projection.aperture;
  job.blur_y = defocus.radius_px_per_D.y * projection.aperture;
  job.lens_x = defocus.radius_px_per_D.x * projection.lens.x;
  job.lens_y = defocus.radius_px_per_D.y * projection.lens.y;
  job.focus_D = defocus.focus_D;
  job.j0 = defocus.astigmatism_D.x;
  job.j45 = defocus.astigmatism_D.y;
  job.astigmatism = blurs(job) ? glm::length(defocus.astigmatism_D) : 0.0f;
  job.gaze_x = projection.acuity.gaze_px.x;
  job.gaze_y = projection.acuity.gaze_px.y;
  job.acuity_base = projection.acuity.base_px;
  job.acuity_per = projection.acuity.per_px;
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

void makeRoom(SplatChunks& chunks, std::size_t splats, const ProjectJob& job) {
  const bool lens = blurs(job), across = job.astigmatism > 0.0f, parts = job.part_aperture > 0.0f;
  if (chunks.capacity < splats) {
    chunks = {};
    chunks.splats = std::make_unique_for_overwrite<Splat[]>(splats);
    chunks.keys = std::make_unique_for_overwrite<SplatKey[]>(splats);
    chunks.capacity = splats;
  }
  const auto room = [&](auto& array, bool wanted) {
    using Element = std::remove_reference_t<decltype(array[0])>;
    if (!wanted) {
      array.reset();
    } else if (!array) {
      array = std::make_unique_for_overwrite<Element[]>(chunks.capacity);
    }
  };
  room(chunks.lens, lens);
  room(chunks.lens_across, across);
  room(chunks.parts, parts);
  room(chunks.out_of_focus_D, parts);
  room(chunks.out_across_D, parts && across);
}

SplatsOut outOf(SplatChunks& chunks, std::size_t first) {
  const auto from = [&](const auto& array) { return array ? array.get() + first : nullptr; };
  return {from(chunks.splats),      from(chunks.keys),  from(chunks.lens),
          from(chunks.lens_across), from(chunks.parts), from(chunks.out_of_focus_D),
          from(chunks.out_across_D)};
}

}  // namespace

void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks) {
  const ProjectJob job = jobOf(cloud.oriented, view, defocus, projection);
  const SurfelArrays surfels = arraysOf(cloud);
  const std::size_t n = cloud.size();
  makeRoom(chunks, n, job);
  chunks.chunk_size = chunkSize(n);
  chunks.count.assign((n + chunks.chunk_size - 1) / chunks.chunk_size, 0);
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    const std::size_t begin = c * chunks.chunk_size;
    const std::size_t end = std::min(n, begin + chunks.chunk_size);
    chunks.count[c] =
        HWY_DYNAMIC_DISPATCH(projectRange)(job, surfels, begin, end, outOf(chunks, begin));
  });
}

void projectCut(const MomentTree& tree, const Cut& cut, const View& view, const Defocus& defocus,
                const Projection& projection, SplatChunks& chunks) {
  const ProjectJob job = jobOf(tree.surfels().oriented, view, defocus, projection);
  const SurfelArrays surfels = arraysOf(tree.surfels());
  const std::size_t size = chunkSize(cut.size());
  const std::size_t node_chunks = (cut.nodes.size() + size - 1) / size;
  const std::size_t range_chunks = node_chunks + (cut.surfels.size() + size - 1) / size;
  // Ranges, as many a chunk as it holds.
  static_assert(Cut::kLongestRange <= kMinChunk);
  std::vector<std::size_t> first_range{0};
  for (std::size_t r = 0, held = 0; r < cut.ranges.size(); ++r) {
    const std::size_t surfel_count = cut.ranges[r].end - cut.ranges[r].begin;
    if (held + surfel_count > size) {
      first_range.push_back(r);
      held = 0;
    }
    held += surfel_count;
  }
  if (!cut.ranges.empty()) first_range.push_back(cut.ranges.size());
  const std::size_t chunk_count = range_chunks + first_range.size() - 1;
  makeRoom(chunks, chunk_count * size, job);
  chunks.chunk_size = size;
  chunks.count.assign(chunk_count, 0);
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    if (c >= range_chunks) {
      for (std::size_t r = first_range[c - range_chunks]; r < first_range[c - range_chunks + 1];
           ++r) {
        chunks.count[c] +=
            HWY_DYNAMIC_DISPATCH(projectRange)(job, surfels, cut.ranges[r].begin, cut.ranges[r].end,
                                               outOf(chunks, c * size + chunks.count[c]));
      }
      return;
    }
    const bool node = c < node_chunks;
    const std::vector<CutEntry>& entries = node ? cut.nodes : cut.surfels;
    const std::size_t begin = (node ? c : c - node_chunks) * size;
    const std::size_t count = std::min(size, entries.size() - begin);
    const SplatsOut out = outOf(chunks, c * size);
    chunks.count[c] =
        node ? HWY_DYNAMIC_DISPATCH(projectNodes)(job, tree.nodes().data(), entries.data() + begin,
                                                  count, out)
             : HWY_DYNAMIC_DISPATCH(projectSome)(job, surfels, entries.data() + begin, count, out);
  });
}

}  // namespace foci
#endif  // HWY_ONCE
