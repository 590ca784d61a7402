// The halos of diffraction (render/optics/diffraction.h) in a finished frame.
#pragma once

#include "render/image/frame.h"
#include "render/optics/diffraction.h"

namespace foci {

/// Spreads the halos' share of the light, in linear RGBA. Halos are wider than what surfaces in
/// front hide, so the frame is spread as a whole. Its border goes on beyond it. Reads the frame
/// from the GPU if it lies there.
/// @param frame  the mean of the parts that have the core's light (`lensParts`)
void spreadIntoHalos(float diffraction_px, Frame& frame);

}  // namespace foci
