// The base of methods that render scenes of Gaussians through the observer's pupil.
#pragma once

#include "render/methods/method.h"

namespace foci {

/// Diffraction spreads all light alike, whatever its distance. So the frame is spread as a whole,
/// in linear light: Gaussians spread one by one would let light through surfaces. The CPU spreads
/// it, also where a GPU renders.
class GaussianEyeMethod : public Method {
 private:
  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) final;

  /// `renderFrame` without diffraction.
  virtual RenderStats renderGeometry(const View& view, const RenderSettings& settings,
                                     Frame& frame) = 0;
};

/// Convolves the linear RGBA of the frame with the discrete Gaussian of this variance,
/// exp(-t) I_n(t) (Lindeberg, Scale-space for discrete signals, PAMI 12(3), 1990). Its variance is
/// exact below a pixel too. The frame continues beyond its border as the border.
/// @param variance_px2  above 0
void spreadLight(Frame& frame, double variance_px2);

}  // namespace foci
