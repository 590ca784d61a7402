// Scenes of Gaussians through a lens whose parts see different images (`Pupil::hasParts`). Each
// part is projected by itself, because its focus and its image are its own.
#pragma once

#include <vector>

#include "render/methods/lens_gaussians.h"
#include "render/methods/method.h"

namespace foci {

/// Keeps its buffers between frames.
class GaussianParts {
 public:
  /// Renders the mean of the parts. Points stay points; other parts are rendered through the
  /// smaller discs of `subApertureDiscs`.
  RenderStats render(LensGaussians& scene, const std::vector<LensPart>& parts, const View& view,
                     const RenderSettings& settings, const GaussianCutSettings* lod, Frame& frame);

 private:
  Frame part_;
};

}  // namespace foci
