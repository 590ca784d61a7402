// Points and Gaussians in glTF: primitives of mode 0 (glTF 2.0, 3.7.2), and KHR_gaussian_splatting
// (Khronos, ratified 2026) with its compression by SPZ.
#pragma once

#include <optional>

#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/point_cloud.h"

namespace foci {

/// What a glTF holds, in the frame of its scene, metres.
struct GltfPoints {
  std::optional<GaussianFile> gaussians{};
  std::optional<PointCloud> points{};
  bool has_triangles = false;
};

/// Reads the points and Gaussians that the nodes of the scene place; triangles are not read.
/// @throws InputError if an attribute is missing, or cannot be read
GltfPoints readGltfPoints(const GltfDocument& gltf);

}  // namespace foci
