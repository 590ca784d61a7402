#include "render/literature/raytrace/mesh_rays.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "base/parallel.h"
#include "render/kernel/limits.h"
#include "render/literature/raytrace/embree_scene.h"

namespace foci {
namespace {

constexpr int kMaxLayers = 1000;  // along a ray through transparent ones
constexpr float kBeyond = 1e-6f;  // relative step past a transparent surface; some float steps

}  // namespace

MeshRays::MeshRays(const TriangleMesh& mesh)
    : mesh_(mesh), scene_(std::make_unique<EmbreeScene>()) {
  RTCGeometry triangles = rtcNewGeometry(scene_->device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners_m = static_cast<float*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), mesh.corners_m.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.size()));
  if (!corners_m || !indices) {
    rtcReleaseGeometry(triangles);
    throw std::runtime_error("Embree: not enough memory for the triangles");
  }
  parallelFor(mesh.size(), [&](std::size_t triangle) {
    for (std::size_t i = 3 * triangle; i < 3 * triangle + 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) corners_m[3 * i + axis] = mesh.corners_m[i][axis];
      indices[i] = static_cast<std::uint32_t>(i);
    }
  });
  scene_->build(triangles);
}

MeshRays::~MeshRays() = default;

RaySeen MeshRays::trace(const glm::vec3& eye_m, const glm::vec3& sight, float footprint) const {
  RaySeen seen;
  float transmittance = 1.0f, from_m = 0.0f;
  for (int surface = 0; surface < kMaxLayers; ++surface) {
    EmbreeContext context;
    RTCRayHit ray{};
    ray.ray.org_x = eye_m.x;
    ray.ray.org_y = eye_m.y;
    ray.ray.org_z = eye_m.z;
    ray.ray.dir_x = sight.x;
    ray.ray.dir_y = sight.y;
    ray.ray.dir_z = sight.z;
    ray.ray.tnear = from_m;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    scene_->intersect(context, ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
    const MeshPoint place{ray.hit.primID, glm::vec2(ray.hit.u, ray.hit.v)};
    const MeshColor color = colorAt(mesh_, place, footprint * ray.ray.tfar);
    seen.hit = seen.hit || color.opacity > 0.0f;
    seen.color += transmittance * color.opacity * color.color;
    transmittance *= 1.0f - color.opacity;
    if (transmittance < kHidden) {
      transmittance = 0.0f;
      break;
    }
    from_m = ray.ray.tfar * (1.0f + kBeyond);
  }
  seen.coverage = 1.0f - transmittance;
  return seen;
}

}  // namespace foci
