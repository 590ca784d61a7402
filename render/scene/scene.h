// A scene: surfels, or the Gaussians of a capture. Scenes are placed in the world and joined to
// one.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "render/scene/gaussian_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What both kinds have (members of one name, `largestSigma`, `withTree`) is reached by
/// `std::visit`, without asking which kind it is.
struct Scene {
  std::variant<SurfelCloud, GaussianCloud> splats;

  /// Null for a scene of Gaussians.
  const SurfelCloud* surfels() const { return std::get_if<SurfelCloud>(&splats); }
  /// Null for a scene of surfels.
  const GaussianCloud* gaussians() const { return std::get_if<GaussianCloud>(&splats); }

  std::span<const glm::vec3> position_m() const;
  /// Surfels or Gaussians.
  std::size_t size() const { return position_m().size(); }
  /// By surfel; empty for Gaussians.
  const SceneObjects& objects() const;
  /// See `GaussianCloud`; absent for surfels.
  std::optional<bool> preservesLight() const;
};

/// As a display shows it (sRGB), 0 to 1; of a Gaussian, without its harmonics.
glm::vec3 displayColorOf(const SurfelCloud& cloud, std::size_t i);
glm::vec3 displayColorOf(const GaussianCloud& cloud, std::size_t i);

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
