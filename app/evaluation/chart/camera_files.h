// The camera of a view in the files of other programs.
#pragma once

#include <string>

#include "render/optics/view.h"
#include "render/scene/scene.h"

namespace foci {

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
