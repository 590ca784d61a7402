// Renders a scene of Gaussians through the lens: one projection and one sorting for all of its
// sub-apertures. The order by depth is the same from every point of the lens, since the lens lies
// in a plane of equal depth.
#pragma once

#include <cstdint>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/gaussians/projected.h"
#include "render/image/frame.h"
#include "render/optics/view.h"
#include "render/splat/bin.h"

namespace foci {

/// Keeps its buffers between frames.
class GaussianView {
 public:
  /// @param cloud  outlives it
  explicit GaussianView(const GaussianCloud& cloud) : cloud_(&cloud) {}

  /// Projects and sorts what any of the discs shows.
  void project(const View& view, const Defocus& defocus, const std::vector<LensDisc>& discs);

  /// Renders the projected view through discs that were projected: the mean over the discs, in linear
  /// light.
  /// @param background  linear RGB
  /// @param frame       has the view's size, and depth where it is wanted
  /// @return kernel evaluations inside of footprints
  std::uint64_t render(const std::vector<LensDisc>& discs, const glm::vec3& background,
                       Frame& frame);

  std::size_t count() const { return projected_.total(); }

 private:
  const GaussianCloud* cloud_;
  Defocus defocus_;
  ProjectedGaussians projected_;
  TileLists lists_;
};

}  // namespace foci
