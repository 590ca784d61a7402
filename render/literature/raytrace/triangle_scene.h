// The triangles of a mesh as one eye or camera sees them, and the rays to them, found by Embree.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/literature/raytrace/embree_scene.h"
#include "render/literature/raytrace/ray_layers.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// Triangles in image space (x px, y px, vergence v), where the points that a pixel sees through a
/// point of the lens lie on a straight line (see `DiscScene`).
///
/// A triangle is flat there for a camera, and bent for an eye. So Embree holds its bounds alone,
/// and the line is met with the triangle's plane in the eye frame:
///   n p(v) = h,  p(v) = d(v) / (v |d(v)|) for an eye, d(v) / v for a camera,
/// where d(v) = (tan x, tan y, -1) is linear in v. Newton-like steps v <- (n d0) / (h |d(v)| - n
/// d1) settle in a few steps, since |d(v)| hardly varies along the line.
class TriangleScene {
 public:
  /// @param mesh  must outlive the scene
  /// Throws std::runtime_error where Embree fails.
  TriangleScene(const TriangleMesh& mesh, const View& view, const Defocus& defocus,
                const Lighting& lighting);

  /// What a point of the image sees through a point of the lens (in lens radii).
  /// @param fragments  grows by the number of surfaces met
  RayColor trace(const glm::vec2& point_px, const glm::vec2& lens, std::uint64_t& fragments) const;

  std::size_t size() const { return seen_.size(); }

 private:
  struct Seen {
    glm::vec3 corners_eye[3];
    std::uint32_t triangle;
  };
  struct Line;
  static void boundsOf(const RTCBoundsFunctionArguments* arguments);
  static void meet(const RTCIntersectFunctionNArguments* arguments);
  void meet(Line& line, std::uint32_t index) const;

  const TriangleMesh& mesh_;
  View view_;
  Defocus defocus_;
  Lighting lighting_;
  float px_per_D_ = 1.0f;   ///< scale of v
  float nearest_D_ = 0.0f;  ///< largest vergence
  std::vector<Seen> seen_;
  EmbreeScene scene_;
};

}  // namespace foci
