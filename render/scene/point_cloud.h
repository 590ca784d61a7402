// Measured points, before surfels are estimated from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Limit of coordinates and lengths from files, metres. Their squares, and sums of these, stay
/// finite.
inline constexpr float kFarthest_m = 1e9f;

/// Measured points as a structure of arrays. `position_m` and `color` have one entry for each
/// point. Each other array has one for each point, or is empty if the file does not give it.
struct PointCloud {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> normal;  ///< unit length; (0, 0, 0): to be estimated
  std::vector<glm::vec3> color;   ///< linear RGB; mid-grey where the file has none
  /// Radius of a disc that closes the gaps to its neighbours, > 0; 0: to be estimated.
  std::vector<float> radius_m;
  std::vector<float> opacity;            ///< 0 to 1
  std::vector<std::uint16_t> body = {};  ///< see `ClosedBodies::of_surfel`
  /// Number of the connected surface of a mesh; its normals are on one side. Empty: unknown.
  std::vector<std::uint32_t> surface = {};
  SceneObjects objects = {};  ///< by point
  /// Mean share of the surface's area around a point. Empty: unknown, since the points are not
  /// samples of a mesh.
  std::vector<float> area_m2 = {};
  std::size_t dropped = 0;  ///< points dropped because their position was not finite
  /// What the file states: its format, metres a unit, and the axis upwards (0 x, 1 y, 2 z).
  std::string format = {};
  std::optional<double> unit_m = {};
  std::optional<int> up_axis = {};
  bool y_is_down = false;  ///< the convention of cameras
  /// What the user should know of the file: a texture that is missing, an origin that was moved.
  /// One sentence each, without the name of the file.
  std::vector<std::string> remarks;

  std::size_t size() const { return position_m.size(); }

  /// Calls `visit` with each array of values by point.
  template <typename Visit>
  void forEachArray(const Visit& visit) {
    visit(position_m);
    visit(normal);
    visit(color);
    visit(radius_m);
    visit(opacity);
    visit(body);
    visit(surface);
    visit(objects.of.own());
    visit(area_m2);
  }
};

}  // namespace foci
