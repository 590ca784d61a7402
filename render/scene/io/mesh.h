// Reads triangle meshes.
#pragma once

#include <filesystem>

#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// Whether a file is a mesh, by its extension (.obj, .gltf, .glb, .stl, .fbx). A PLY file is a mesh
/// if it has faces or triangle strips.
/// @throws InputError if the header of a PLY file is broken
bool isMeshFile(const std::filesystem::path& path);

struct MeshFile {
  TriangleMesh mesh;
  SceneFacts facts;  ///< but the positions and the remarks, which the mesh has
};

/// Reads all triangles of a mesh file, in its units, with the nodes' transforms applied. Triangles
/// are turned to the side of the file's own normals if it has some. Vertex colours are sRGB, but
/// linear in glTF. Alpha cuts holes or makes surfaces transparent, as glTF states; in other files,
/// a texture's alpha below 0.5 is a hole, and so is the mask of an OBJ.
///
/// A texture that cannot be read, or has more than 2^26 pixels, and a file of materials that cannot
/// be read are named in the mesh's remarks. The material's colour then shows.
///
/// @throws InputError if the file is damaged, if no triangle has an area, or if a texture or a file
///         of materials is a pipe or a device
MeshFile readMesh(const std::filesystem::path& path);

}  // namespace foci
