// Rays through pinholes against the triangles of a mesh, found by Embree. The triangles stay in the
// world frame, so that one scene serves any number of views.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

class EmbreeScene;

/// What a ray meets, composited from the nearest surface to the farthest.
struct RaySeen {
  glm::vec3 color{0.0f};  ///< linear RGB times coverage
  float coverage = 0.0f;  ///< 0 to 1; below 1 behind transparent surfaces only
  bool hit = false;       ///< met a surface that is not cut out
};

/// `TriangleScene` finds the same surfaces through any lens, but is built for one view.
class MeshRays {
 public:
  /// @param mesh  must outlive the rays
  /// Throws std::runtime_error where Embree fails.
  explicit MeshRays(const TriangleMesh& mesh);
  ~MeshRays();

  /// @param sight      unit length
  /// @param footprint  side of a pixel over its distance: textures are averaged over it
  RaySeen trace(const glm::vec3& eye_m, const glm::vec3& sight, float footprint) const;

 private:
  const TriangleMesh& mesh_;
  std::unique_ptr<EmbreeScene> scene_;
};

}  // namespace foci
