// One scene of several: each part is placed in the world, then all are joined.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>

#include "render/scene/scene.h"

namespace foci {

/// Where a part stands: first turned, then moved.
struct Placement {
  glm::vec3 position_m{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};  ///< unit
};

/// Moves a part (`transform`).
Scene placed(Scene part, const Placement& place);

/// Both scenes in one. Where either holds Gaussians, surfels become flat Gaussians
/// (`gaussiansOf`). A part of surfels is an object of that name, unless it has objects of its own.
Scene joined(Scene scene, Scene part, const std::string& name);

/// Without a tree, of the higher degree. The first says how small Gaussians are low-passed.
GaussianCloud joined(GaussianCloud cloud, GaussianCloud part);

/// What the user should know where captured scenes, which are then joined, were trained with
/// different low-passes: `joined` keeps that of the first. Nothing where they agree, or one has
/// surfels only.
std::optional<std::string> lowPassRemark(const Scene& scene, const std::string& scene_name,
                                         const Scene& part, const std::string& part_name);

/// Flat Gaussians on the surfels. A surfel's kernel is widened by `kFlatWidening`, so that
/// Gaussians composited front to back cover the surface: with samples on a grid less than 0.1 % of
/// the light passes. Colours become display values.
GaussianCloud gaussiansOf(const SurfelCloud& surfels);
inline constexpr float kFlatWidening = 1.5f;

}  // namespace foci
