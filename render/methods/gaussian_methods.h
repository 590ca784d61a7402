// The methods that render scenes of Gaussians, for the registry (method.h). Each has the meaning of
// the method of the same name on surfels.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/methods/method.h"
#include "render/scene/gaussian_cloud.h"

namespace foci {

/// The whole lens for `n` = 1; else `n` sub-apertures, discs that lie evenly on it. Centres and
/// discs together have the lens's variance.
std::vector<LensDisc> subApertureDiscs(int n);

/// Radius of the disc that renders one of `n` sub-apertures, over the radius of that sub-aperture.
float partDiscRadius(std::size_t n);

std::unique_ptr<Method> gaussianPinhole(const GaussianCloud& cloud, int n, const SharedGpu& gpu);
std::unique_ptr<Method> gaussianSweep(const GaussianCloud& cloud, int n, const SharedGpu& gpu);
std::unique_ptr<Method> gaussianSweepLod(const GaussianCloud& cloud, int n, const SharedGpu& gpu);
std::unique_ptr<Method> gaussianAccumulate(const GaussianCloud& cloud, int n, const SharedGpu& gpu);
/// Factor on the blur radius with which the Gaussian blur C^2 / (2 ln 4) becomes that of the
/// variant of `inflate`: C^2 for 1 (Spark), (2C)^2 for 2 (splat-transform); 1 for 0.
float inflateWidening(int variant);

/// @param n  variant of `inflate`
std::unique_ptr<Method> gaussianInflate(const GaussianCloud& cloud, int n, const SharedGpu& gpu);
std::unique_ptr<Method> gaussianAuto(const GaussianCloud& cloud, int n, const SharedGpu& gpu);

}  // namespace foci
