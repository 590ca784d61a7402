// The scene of a chart and its camera for other programs: points, 3D Gaussians, a textured mesh,
// and the view in the files of NeRF tools and COLMAP.
#pragma once

#include <filesystem>
#include <string>

#include "render/optics/view.h"
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

/// The `transforms.json` of NeRF and Gaussian tools. `transform_matrix` is world from camera, with
/// the axes of OpenGL: x right, y up, the camera looks along -z.
/// @param image, points  file names beside it; `points` may be empty
std::string nerfTransforms(const View& view, const std::string& image, const std::string& points);

/// A COLMAP model as text. Its camera has x right, y down and looks along +z.
struct ColmapModel {
  std::string cameras, images, points3D;
};

/// @param scene  a thousand of its points go to points3D.txt
ColmapModel colmapModel(const View& view, const std::string& image, const Scene& scene);

}  // namespace foci
