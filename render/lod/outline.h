// A coarse outline of a large scene: where it is, and what it looks like from afar. It reads a few
// megabytes of the scene's file instead of all of it.
#pragma once

#include <cstddef>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// A scene with a tree counts as large if it has more surfels.
inline constexpr std::size_t kLargeScene = std::size_t{1} << 24;

/// The nodes of a middle level of the tree as round surfels. Each reaches as far as its node at
/// three standard deviations. Empty if the scene is not large, or has no tree.
SurfelCloud outlineOf(const SurfelCloud& cloud, std::size_t large = kLargeScene);

}  // namespace foci
