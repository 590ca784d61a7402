// What is wrong with the place of an eye in a scene: nothing in view, an eye inside a solid, a
// scene of a size that no eye can focus in, or one too large for the method.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/study/study.h"
#include "render/lod/moment_tree.h"
#include "render/optics/view.h"
#include "render/scene/scene.h"

namespace foci {

/// A scene wider than this, or narrower, is remarked on: farther away than 100 m the optics of an
/// eye hardly tell distances apart, and an eye focuses on nothing nearer than some centimetres.
inline constexpr double kWidestScene_m = 1000.0, kNarrowestScene_m = 0.001;

/// What an eye in the study's first pose sees.
View firstViewOf(const Study& study);

/// Whether any surfel may reach into the image that an eye in the study's first pose sees.
bool isSceneInView(const Study& study, const Scene& scene);

/// One sentence for each fault, with the key to set; empty for an ordinary view. Looks at the eye's
/// pose at the beginning, or the scene's own pose. The eye stands inside a solid if it sees the
/// backs of oriented surfels in nearly all directions, or any surfels nearer than 2 cm.
std::vector<std::string> viewRemarks(const Study& study, const Scene& scene);

/// How much memory the study's method takes, and which methods take less; empty for a scene that is
/// not large, and for a method with level of detail.
std::string memoryRemark(const Study& study, const Scene& scene, std::size_t large = kLargeScene);

}  // namespace foci
