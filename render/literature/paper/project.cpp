#include "render/literature/paper/project.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/literature/paper/project.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include "render/literature/paper/project_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace {

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

  // Tiles that hold pixel centres inside the footprint's box.
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

  // The last surfels go through copies that are padded to a full step.
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
