// A mesh as its triangles show it from one side, for comparison with its surfels.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/view.h"

namespace foci {

class MeshRays;

/// A pixel of the surfels' image gathers light from less than this distance: the support of the
/// pixel filter, sqrt(8) px, rounded up (render/kernel/limits.h, kWidestSupport2).
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

}  // namespace foci
