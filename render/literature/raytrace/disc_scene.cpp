#include "render/literature/raytrace/disc_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "render/kernel/kernel.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {
namespace {

/// A surfel's hit at an offset from the splat's centre, seen through a lens point. The weight
/// equals the projection's (render/splat/project.cpp).
std::optional<Hit> hitAt(const SeenSurfel& surfel, std::uint32_t index,
                         const glm::vec2& lens_px_per_D, const glm::vec2& offset) {
  const glm::vec2 u = surfel.u_px + lens_px_per_D * surfel.u_D;
  const glm::vec2 v = surfel.v_px + lens_px_per_D * surfel.v_D;
  static const KernelShape shape = kernelShape(kMaxExponent);
  const float vxx = u.x * u.x + v.x * v.x + 1.0f, vyy = u.y * u.y + v.y * v.y + 1.0f;
  const float area_px = surfel.area_per_axes * std::abs(u.x * v.y - u.y * v.x);
  if (!(area_px > 0.0f && area_px < kLargest_px2 && vxx < kLargest_px2 && vyy < kLargest_px2)) {
    return std::nullopt;
  }
  const float vxy = u.x * u.y + v.x * v.y, det = vxx * vyy - vxy * vxy;
  const float q_det =
      vyy * offset.x * offset.x - 2.0f * vxy * offset.x * offset.y + vxx * offset.y * offset.y;
  if (!(q_det < shape.support2 * det)) return std::nullopt;
  const float t = 1.0f - q_det / (shape.support2 * det);
  const float weight = shape.at(t) * area_px / (shape.support2 * std::sqrt(det));
  return Hit{index, weight, -offset / std::sqrt(shape.support2 * std::min(vxx, vyy))};
}

/// A ray and the hits that it gathers, as Embree hands them back to the filter.
struct Gathering {
  EmbreeContext context;  // first: Embree knows this member only
  const std::vector<SeenSurfel>* surfels;
  glm::vec2 lens_px_per_D;
  glm::vec2 pixel;
  float focus_D;
  std::vector<Hit>* hits;
};

/// Records a hit and lets the ray continue.
void gather(const RTCFilterFunctionNArguments* arguments) {
  arguments->valid[0] = 0;
  const auto& ray = *reinterpret_cast<const Gathering*>(arguments->context);
  const auto index = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const SeenSurfel& surfel = (*ray.surfels)[index];
  const glm::vec2 center = surfel.center_px + ray.lens_px_per_D * (ray.focus_D - surfel.vergence_D);
  const auto hit = hitAt(surfel, index, ray.lens_px_per_D, ray.pixel - center);
  if (hit && hit->weight > 0.0f) ray.hits->push_back(*hit);
}

SeenSurfel seen(const SurfelCloud& cloud, std::size_t i, const View& view,
                const glm::mat3& rotation, DistanceAlong along, const Lighting& lighting) {
  const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
  const glm::vec3 u = rotation * cloud.axis_u_m[i], v = rotation * cloud.axis_v_m[i];
  const float depth_m = -p.z;
  const glm::vec2 tangent = glm::vec2(p) / depth_m;
  const glm::vec2 px_per_m = view.focal_px * glm::vec2(1.0f, -1.0f) / depth_m;
  const bool along_axis = along == DistanceAlong::axis;
  const float distance_m = along_axis ? depth_m : glm::length(p);
  const float u_m = along_axis ? -u.z : glm::dot(u, p) / distance_m;
  const float v_m = along_axis ? -v.z : glm::dot(v, p) / distance_m;
  const float vergence_D = 1.0f / distance_m;
  const float uu = glm::dot(u, u), vv = glm::dot(v, v), parallelogram = std::sqrt(uu * vv);
  const float reach_m = std::sqrt(kReach2 * (u_m * u_m + v_m * v_m) + std::max(uu, vv));
  const float away = glm::dot(glm::cross(u, v), p) / (parallelogram * glm::length(p));
  const float opacity = opacityOf(cloud, i);
  const float shade = lighting.shade(std::abs(away));
  return {.center_px = project(view, p),
          .u_px = px_per_m * (glm::vec2(u) + u.z * tangent),
          .v_px = px_per_m * (glm::vec2(v) + v.z * tangent),
          .u_D = u_m * vergence_D * vergence_D,
          .v_D = v_m * vergence_D * vergence_D,
          .vergence_D = vergence_D,
          .area_per_axes = cloud.area_m2[i] / parallelogram,
          .color = shade * opacity * cloud.color[i],
          .opacity = opacity,
          .back_facing = cloud.oriented && away > 0.0f,
          .distance_m = distance_m,
          .near_m = std::max(distance_m - reach_m, 0.0f),
          .far_m = distance_m + reach_m};
}

/// A sum with a term that is not finite is not finite.
bool allFinite(const SeenSurfel& surfel) {
  return std::isfinite(surfel.center_px.x + surfel.center_px.y + surfel.far_m +
                       surfel.area_per_axes + surfel.u_D + surfel.v_D);
}

}  // namespace

DiscScene::DiscScene(const std::vector<SeenSurfel>& surfels, const Defocus& defocus)
    : surfels_(surfels), defocus_(defocus) {
  // Scale v so that a dioptre is as long as the largest shift of a line over a dioptre.
  const float steepest = std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  px_per_D_ = steepest > 0.0f && std::isfinite(steepest) ? steepest : 1.0f;
  RTCGeometry discs = rtcNewGeometry(scene_.device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  auto* vertices = static_cast<glm::vec4*>(rtcSetNewGeometryBuffer(
      discs, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), surfels.size()));
  auto* normals = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      discs, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), surfels.size()));
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const glm::vec4 disc = discOf(surfels[i]);
    vertices[i] = disc;
    normals[i] = {0.0f, 0.0f, 1.0f};
    nearest_ = std::min(nearest_, disc.z - 4.0f * disc.w);
    furthest_ = std::max(furthest_, disc.z + 1.0f);
  }
  rtcSetGeometryIntersectFilterFunction(discs, gather);
  scene_.build(discs);
}

void DiscScene::trace(const glm::vec2& pixel, const glm::vec2& lens, std::vector<Hit>& hits) const {
  hits.clear();
  Gathering line{.context = {},
                 .surfels = &surfels_,
                 .lens_px_per_D = lens * defocus_.radius_px_per_D,
                 .pixel = pixel,
                 .focus_D = defocus_.focus_D,
                 .hits = &hits};
  const glm::vec2 j = defocus_.astigmatism_D;
  line.pixel -= defocus_.radius_px_per_D *
                glm::vec2(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
  const glm::vec2 slope = line.lens_px_per_D / px_per_D_;
  const glm::vec2 from = line.pixel - line.lens_px_per_D * defocus_.focus_D + slope * nearest_;
  scene_.trace(line.context, {from, nearest_}, {slope, 1.0f}, 0.0f, furthest_ - nearest_);
  std::ranges::sort(hits, {}, &Hit::surfel);
}

/// A disc that contains the footprint through every lens point, with a margin for rounding.
glm::vec4 DiscScene::discOf(const SeenSurfel& surfel) const {
  const float lens_px_per_D = std::max(defocus_.radius_px_per_D.x, defocus_.radius_px_per_D.y);
  const float u = glm::length(surfel.u_px) + lens_px_per_D * std::abs(surfel.u_D);
  const float v = glm::length(surfel.v_px) + lens_px_per_D * std::abs(surfel.v_D);
  const float radius = std::sqrt(kWidestSupport2 * (u * u + v * v + 1.0f));
  const float z = surfel.vergence_D * px_per_D_;
  const float rounding = 1e-5f * (std::abs(surfel.center_px.x) + std::abs(surfel.center_px.y) + z);
  return {surfel.center_px, z, 1.001f * radius + rounding};
}

std::vector<SeenSurfel> seenSurfels(const SurfelCloud& cloud, const View& view, DistanceAlong along,
                                    const Lighting& lighting) {
  const glm::mat3 rotation(view.eye_from_world);
  std::vector<SeenSurfel> all(cloud.size());
  std::vector<std::uint8_t> kept(cloud.size());
  parallelFor(cloud.size(), [&](std::size_t i) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
    if (!(-p.z >= view.near_m)) return;
    all[i] = seen(cloud, i, view, rotation, along, lighting);
    kept[i] = allFinite(all[i]);
  });
  keepMarked(all, kept);
  std::ranges::stable_sort(all, {}, &SeenSurfel::distance_m);
  return all;
}

}  // namespace foci
