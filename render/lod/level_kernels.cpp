#include "render/lod/level_kernels.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {
namespace {

constexpr float kThinnest = 1e-3f;  // lower bound of a kernel's shorter axis over the longer

}  // namespace

LevelKernels levelKernels(const MomentTree& tree, int level) {
  assert(level >= 0 && level < tree.levels());
  LevelKernels kernels;
  const std::size_t first = std::size_t{1} << level;
  for (std::size_t i = first; i < 2 * first; ++i) {
    const LodNode& node = tree.nodes()[i];
    const glm::vec3 normal = unpackNormal(node.normal);
    const glm::vec3 x = tangentTo(normal), y = glm::cross(normal, x);

    // The variance in the plane across the normal, and its axes.
    const float xx = node.covariance_m2(x, x), yy = node.covariance_m2(y, y);
    const float xy = node.covariance_m2(x, y);
    const auto angle = static_cast<float>(0.5 * std::atan2(2.0 * xy, double{xx - yy}));
    const float middle = 0.5f * (xx + yy), apart = std::hypot(0.5f * (xx - yy), xy);
    const float own = static_cast<float>(node.own) * (1.0f / 65535.0f);
    const float u = std::sqrt(own * (middle + apart));
    const float v = std::max(std::sqrt(own * std::max(middle - apart, 0.0f)), kThinnest * u);

    kernels.surfels.position_m.push_back(node.position_m);
    kernels.surfels.axis_u_m.push_back(u * (std::cos(angle) * x + std::sin(angle) * y));
    kernels.surfels.axis_v_m.push_back(v * (std::cos(angle) * y - std::sin(angle) * x));
    kernels.surfels.color.push_back(node.color);
    kernels.surfels.area_m2.push_back(node.density * std::sqrt(std::max(xx * yy - xy * xy, 0.0f)));
    kernels.added_m2.push_back(0.5f * (1.0f - own) * node.trace_m2());
  }
  return kernels;
}

}  // namespace foci
