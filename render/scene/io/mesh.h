// Samples the surface of triangle meshes, which Assimp reads.
#pragma once

#include <cstddef>
#include <filesystem>

#include "render/scene/point_cloud.h"

namespace foci {

struct MeshSampling {
  std::size_t points = 500'000;  ///< about; 1 to 10^8
};

/// Whether a file is a mesh, by its extension (.obj, .gltf, .glb, .stl). A PLY file is a mesh if it
/// has faces.
/// @throws InputError if the header of a PLY file is broken
bool isMeshFile(const std::filesystem::path& path);

/// Samples points evenly over all triangles of the file (poisson_disk.h), with the nodes'
/// transforms applied. Normals are the triangles', on the side of the file's own normals if it has
/// some. Opacity is the material's.
///
/// The linear colour of a point comes from the first of these that the file has.
///
/// The texture (base colour or diffuse), averaged over the point's surroundings. In glTF it is
/// multiplied by the base colour's factor. Where its alpha is below a half there is no surface,
/// unless glTF calls the material opaque.
///
/// The vertices: sRGB, but linear in glTF.
///
/// The material, under a light from above and in front that shows the shape.
///
/// @throws InputError if Assimp cannot read the file, if no triangle has an area, or if a texture
///         cannot be read or has more than 2^26 pixels
PointCloud sampleMesh(const std::filesystem::path& path, const MeshSampling& sampling = {});

}  // namespace foci
