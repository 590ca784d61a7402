// Triangle meshes (through Assimp) as points of their surface.
#pragma once

#include <cstddef>
#include <filesystem>

#include "render/scene/point_cloud.h"

namespace foci {

struct MeshSampling {
  std::size_t points = 500'000;  ///< about; 1 to 10^8
};

/// Whether a file is a mesh: by its extension (.obj, .gltf, .glb, .stl), a PLY where it has faces.
/// @throws InputError where a PLY has a broken header
bool isMeshFile(const std::filesystem::path& path);

/// Points by Poisson-disk sampling, evenly over all triangles of the file, nodes' transforms
/// applied, with the triangles' normals (turned as the file's own normals where it has some).
/// Colours, linear:
///   - of the texture (base colour or diffuse; averaged over a point's surroundings), times the
///   base
///     colour's factor in glTF; where its alpha is below a half, there is no surface, unless glTF
///     calls the material opaque;
///   - else of the vertices (sRGB, but linear in glTF);
///   - else the material's, under a light from above and in front, since nothing else would show
///   its shape.
/// Opacity is the material's.
/// @throws InputError for what Assimp cannot read, has no triangle with an area, or whose textures
/// cannot be
///         read or have more than 2^26 pixels
PointCloud sampleMesh(const std::filesystem::path& path, const MeshSampling& sampling = {});

}  // namespace foci
