// A mesh as its triangles show it from one side, for comparison with its surfels: rays through
// pinholes, found by Embree.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/view.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

class EmbreeScene;
class MeshRays;

/// A pixel of the surfels' image gathers light from less than this distance: the support of the
/// pixel filter, sqrt(8) px, rounded up (render/kernel/kernel.h, kWidestSupport2).
inline constexpr int kFilterReach_px = 3;

/// The triangles through a pinhole, before black. Row by row, as `Frame`. Pixels at the border of
/// the image, within the filter's reach, count neither as interior nor as outline.
struct TriangleView {
  /// Filtered as the surfels' images are: the kernel (1 - r^2 / 8)^2 of a sharp point, whose
  /// variance is one square pixel.
  Frame frame;
  /// 1 where every ray within `kFilterReach_px` pixels, along rows and columns, ends on an opaque
  /// surface.
  std::vector<std::uint8_t> interior;
  /// 1 where some rays within that reach meet a surface and others meet none.
  std::vector<std::uint8_t> outline;
  std::size_t transparent = 0;  ///< pixels inside the silhouette that are not opaque
};

/// Traces one ray a pixel; 2 x 2 where neighbours differ in colour, 4 x 4 where they differ in
/// what is hit: at outlines. Textures are averaged over half a pixel.
TriangleView triangleView(const MeshRays& mesh, const View& view);

/// Length of the outlines in an image, px: the integral of the coverage's gradient, which is the
/// length of a sharp or blurred edge of any direction.
/// @param where  1 for the pixels to integrate over
double outlineLength_px(const Frame& frame, const std::vector<std::uint8_t>& where);

/// What a ray meets, composited from the nearest surface to the farthest.
struct RaySeen {
  glm::vec3 color{0.0f};  ///< linear RGB times coverage
  float coverage = 0.0f;  ///< 0 to 1; below 1 behind transparent surfaces only
  bool hit = false;       ///< met a surface that is not cut out
};

/// Rays against triangles in the world frame, so that one scene serves any number of views.
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
