#include "render/scene/mesh/triangle_mesh.h"

#include <cmath>

#include "render/scene/mesh/texture.h"

namespace foci {
namespace {

constexpr float kMinAlpha = 0.5f;  // glTF's default alphaCutoff

}  // namespace

MeshColor colorAt(const TriangleMesh& mesh, const MeshPoint& point, float footprint_m) {
  static const MeshMaterial plain;
  const std::uint32_t m = mesh.material[point.triangle];
  const MeshMaterial& material = m < mesh.materials.size() ? mesh.materials[m] : plain;
  const std::size_t first = 3 * std::size_t{point.triangle};
  const auto blend = [&](const auto& values) {
    return values[first] + point.weights.x * (values[first + 1] - values[first]) +
           point.weights.y * (values[first + 2] - values[first]);
  };
  if (material.texture) {
    const glm::vec2 a = (mesh.uv[first + 1] - mesh.uv[first]) * material.texture->size_px();
    const glm::vec2 b = (mesh.uv[first + 2] - mesh.uv[first]) * material.texture->size_px();
    const float area_px = std::abs(a.x * b.y - a.y * b.x);
    const float area_m2 =
        glm::length(glm::cross(mesh.corners_m[first + 1] - mesh.corners_m[first],
                               mesh.corners_m[first + 2] - mesh.corners_m[first]));
    const glm::vec4 texel =
        material.texture->at(blend(mesh.uv), footprint_m * std::sqrt(area_px / area_m2));
    const bool cut = material.cut_out && texel.w < kMinAlpha;
    return {glm::vec3(texel) * material.factor, cut ? 0.0f : material.opacity};
  }
  if (!mesh.color.empty() && mesh.color[first].x >= 0.0f) {
    return {blend(mesh.color), material.opacity};
  }
  return {material.factor, material.opacity};
}

}  // namespace foci
