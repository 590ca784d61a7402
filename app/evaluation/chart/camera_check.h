// Compares the sharp image of another renderer's camera with the one expected.
#pragma once

#include <string>

#include "render/image/frame.h"

namespace foci {

/// What is wrong with a sharp image: shifted, mirrored, in another gamma, or of another view. Empty
/// if it agrees as well as the images of two renderers do. The frames have one size (asserted).
std::string cameraFault(const Frame& sharp, const Frame& expected);

}  // namespace foci
