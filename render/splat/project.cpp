#include "render/splat/project.h"

#include <hwy/cache_control.h>

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After foreach_target.h:
#include "render/splat/finish_splats-inl.h"
#include "render/splat/project_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
/// Copies of up to 16 surfels, for a SIMD step that surfels in memory do not fill.
struct SurfelCopies {
  alignas(64) float position[48] = {}, axis_u[48] = {}, axis_v[48] = {}, area[16] = {};

  void set(std::size_t k, const SurfelArrays& from, std::size_t i) {
    std::copy_n(from.position + 3 * i, 3, position + 3 * k);
    std::copy_n(from.axis_u + 3 * i, 3, axis_u + 3 * k);
    std::copy_n(from.axis_v + 3 * i, 3, axis_v + 3 * k);
    area[k] = from.area[i];
  }
  SurfelArrays arrays() const {
    return {position, axis_u, axis_v, area, nullptr, nullptr, nullptr};
  }
};

bool isOneSided(const ProjectJob& job, const SurfelArrays& surfels, std::size_t i) {
  return job.outside != nullptr && job.outside[surfels.body[i]] != 0;
}

bool isOneSided(const ProjectJob& job, const Facing* facing, std::size_t node) {
  return job.outside != nullptr && facing[node].body != Facing::kSeveral &&
         facing[node].cos_cone != 0 && job.outside[facing[node].body] != 0;
}

/// Whether a node holds both sides of a body that the whole lens sees from outside.
bool holdsBothSides(const ProjectJob& job, const Facing* facing, std::size_t node) {
  return job.outside != nullptr && facing[node].body != Facing::kSeveral &&
         facing[node].cos_cone == 0 && job.outside[facing[node].body] != 0;
}

/// Projects surfels [begin, end); returns the number of splats.
std::uint32_t projectRange(const ProjectJob& job, const SurfelArrays& surfels, std::size_t begin,
                           std::size_t end, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  ProjectedLanes lanes;
  std::size_t i = begin;
  const auto appearanceOf = [&](std::size_t k) {
    return Appearance{surfels.color + 3 * (i + k), surfels.opacity ? surfels.opacity[i + k] : 1.0f,
                      1.0f, isOneSided(job, surfels, i + k)};
  };
  for (; i + n <= end; i += n) {
    projectLanes(job, surfels, i, lanes);
    finishLanes(job, lanes, n, appearanceOf, out, count);
  }
  if (i < end) {
    SurfelCopies copies;
    for (std::size_t k = 0; k < end - i; ++k) copies.set(k, surfels, i + k);
    projectLanes(job, copies.arrays(), 0, lanes);
    finishLanes(job, lanes, end - i, appearanceOf, out, count);
  }
  return count;
}

/// Projects the surfels of cut entries; returns the number of splats.
std::uint32_t projectSome(const ProjectJob& job, const SurfelArrays& surfels,
                          const CutEntry* entries, std::size_t entry_count, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  ProjectedLanes lanes;
  SurfelCopies copies;
  for (std::size_t e = 0; e < entry_count; e += n) {
    const std::size_t some = std::min(n, entry_count - e);
    for (std::size_t k = 0; k < some; ++k) copies.set(k, surfels, entries[e + k].index);
    projectLanes(job, copies.arrays(), 0, lanes);
    const auto appearanceOf = [&](std::size_t k) {
      const std::size_t i = entries[e + k].index;
      return Appearance{surfels.color + 3 * i, surfels.opacity ? surfels.opacity[i] : 1.0f,
                        entries[e + k].weight, isOneSided(job, surfels, i)};
    };
    finishLanes(job, lanes, some, appearanceOf, out, count);
  }
  return count;
}

/// Projects the nodes of cut entries; returns the number of splats.
std::uint32_t projectNodes(const ProjectJob& job, const LodNode* nodes, const Facing* facing,
                           const CutEntry* entries, std::size_t entry_count, const SplatsOut& out) {
  const std::size_t n = hn::Lanes(D());
  std::uint32_t count = 0;
  ProjectedLanes lanes;
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
    const auto appearanceOf = [&](std::size_t k) {
      const LodNode& node = nodes[entries[e + k].index];
      return Appearance{&node.color.x, static_cast<float>(node.opacity) * (1.0f / 65535.0f),
                        entries[e + k].weight, isOneSided(job, facing, entries[e + k].index),
                        holdsBothSides(job, facing, entries[e + k].index)};
    };
    finishLanes(job, lanes, some, appearanceOf, out, count);
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

/// @param outside  `bodiesFromOutside`
ProjectJob jobOf(bool oriented, const View& view, const Defocus& defocus,
                 const Projection& projection, const std::vector<std::uint8_t>& outside) {
  const glm::mat3 rows = glm::transpose(glm::mat3(view.eye_from_world));
  // Astigmatism displaces all points alike, whatever their distance, for a given lens point.
  const glm::vec2 lens = projection.lens, j = defocus.astigmatism_D,
                  radius = defocus.radius_px_per_D;
  const glm::vec2 aside_D(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
  const LensField* field = shownField(defocus);
  ProjectJob job{.rows = rows,
                 .eye = -rows * glm::vec3(view.eye_from_world[3]),
                 .focal = view.focal_px,
                 .principal = view.principal_px + (field ? glm::vec2(0.0f) : radius * aside_D),
                 .size = view.size_px,
                 .near_m = view.near_m,
                 .margin = static_cast<float>(projection.margin_px),
                 .blur = radius * projection.aperture,
                 .focus_D = defocus.focus_D,
                 .j = j,
                 .astigmatism = 0.0f,
                 .lens = field ? glm::vec2(0.0f) : radius * lens,
                 .sub_aperture = projection.sub_aperture,
                 .acuity = projection.acuity,
                 .along_axis = defocus.along == DistanceAlong::axis,
                 .gaussian = projection.kernel == BlurKernel::gaussian,
                 .oriented = oriented,
                 .lighting = projection.lighting,
                 .shapes = kernelShapes().data(),
                 .outside = outside.empty() ? nullptr : outside.data(),
                 .lens_m = lensRadius_m(view, defocus),
                 .lens_px_per_D = std::sqrt(radius.x * radius.y),
                 .field = field,
                 .centre = lens,
                 .aperture = projection.aperture};
  if (blurs(job)) job.astigmatism = glm::length(j);
  return job;
}

SurfelArrays arraysOf(const SurfelCloud& cloud) {
  if (cloud.empty()) return {};
  return {&cloud.position_m[0].x,
          &cloud.axis_u_m[0].x,
          &cloud.axis_v_m[0].x,
          cloud.area_m2.data(),
          &cloud.color[0].x,
          cloud.opacity.empty() ? nullptr : cloud.opacity.data(),
          cloud.bodies.of_surfel.empty() ? nullptr : cloud.bodies.of_surfel.data()};
}

void makeRoom(SplatChunks& chunks, std::size_t splats, const ProjectJob& job) {
  // A part of the lens is too small to need lens points.
  const bool lens = blurs(job) && job.aperture == 1.0f, field = lens && job.field,
             across = lens && (field || job.astigmatism > 0.0f),
             sub_apertures = job.sub_aperture > 0.0f;
  if (chunks.capacity < splats) {
    chunks = {};
    chunks.splats = makeLargeArray<Splat>(splats);
    chunks.keys = makeLargeArray<SplatKey>(splats);
    chunks.capacity = splats;
  }
  const auto room = [&](auto& array, bool wanted) {
    using Element = std::remove_reference_t<decltype(array[0])>;
    if (!wanted) {
      array.reset();
    } else if (!array) {
      array = makeLargeArray<Element>(chunks.capacity);
    }
  };
  room(chunks.lens, lens);
  room(chunks.lens_across, across);
  room(chunks.sub_aperture_splats, sub_apertures);
  room(chunks.out_of_focus_D, sub_apertures && !field);
  room(chunks.out_across_D, sub_apertures && across && !field);
  room(chunks.lens_px, sub_apertures && field);
}

SplatsOut outOf(SplatChunks& chunks, std::size_t first) {
  const auto from = [&](const auto& array) { return array ? array.get() + first : nullptr; };
  return {from(chunks.splats),
          from(chunks.keys),
          from(chunks.lens),
          from(chunks.lens_across),
          from(chunks.sub_aperture_splats),
          from(chunks.out_of_focus_D),
          from(chunks.out_across_D),
          from(chunks.lens_px)};
}

}  // namespace

void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks) {
  const std::vector<std::uint8_t> outside = bodiesFromOutside(cloud.bodies, view, defocus);
  const ProjectJob job = jobOf(cloud.oriented, view, defocus, projection, outside);
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
  const std::vector<std::uint8_t> outside = bodiesFromOutside(tree.surfels().bodies, view, defocus);
  const ProjectJob job = jobOf(tree.surfels().oriented, view, defocus, projection, outside);
  const SurfelArrays surfels = arraysOf(tree.surfels());
  const std::size_t size = chunkSize(cut.size());
  const std::size_t node_chunks = (cut.nodes.size() + size - 1) / size;
  const std::size_t range_chunks = node_chunks + (cut.surfels.size() + size - 1) / size;
  // Fill each further chunk with as many ranges of surfels as it holds.
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
        node ? HWY_DYNAMIC_DISPATCH(projectNodes)(job, tree.nodes().data(), tree.facing().data(),
                                                  entries.data() + begin, count, out)
             : HWY_DYNAMIC_DISPATCH(projectSome)(job, surfels, entries.data() + begin, count, out);
  });
}

}  // namespace foci
#endif  // HWY_ONCE
