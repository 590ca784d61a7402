#include "render/lod/outline.h"

#include <algorithm>

#include "render/lod/moment_tree.h"

namespace foci {

SurfelCloud outlineOf(const SurfelCloud& cloud, std::size_t large) {
  constexpr int kLevel = 16;
  SurfelCloud outline;
  const std::shared_ptr<const MomentTree> built = builtTree(cloud);
  if (!built || cloud.size() <= large) return outline;
  const MomentTree& tree = *built;
  const std::size_t first = std::size_t{1} << std::min(kLevel, tree.levels() - 1);
  for (std::size_t i = first; i < 2 * first; ++i) {
    const LodNode& node = tree.nodes()[i];
    appendSurfel(outline, node.position_m, unpackNormal(node.normal), node.radius_m / 3.0f,
                 node.density * node.trace_m2(), node.color,
                 static_cast<float>(node.opacity) * (1.0f / 65535.0f));
  }
  outline.oriented = cloud.oriented;
  return outline;
}

}  // namespace foci
