// The scene of a chart for other programs: points, 3D Gaussians, and a textured mesh.
#pragma once

#include <filesystem>

#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/scene.h"

namespace foci {

/// Surfels as points with normal, colour, opacity and the radius that gives their size back
/// (`writePly`).
void writePoints(const std::filesystem::path& file, const SurfelCloud& surfels);

/// The PLY of Kerbl et al. 2023. A surfel becomes a flat Gaussian. Gaussians are composited where
/// kernels of surfels sum to one, so a viewer shows about the surfels' image.
void writeGaussians(const std::filesystem::path& file, const Scene& scene);

/// Binary glTF 2.0, unlit: the light of a place is its colour.
/// @param mesh  one material with a texture (asserted), which alone gives the colour
void writeGlb(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace foci
