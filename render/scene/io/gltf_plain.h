// Rewrites a glTF so that Assimp 5.2 reads it correctly. Private to the readers of meshes.
#pragma once

#include <string>

#include "render/scene/io/gltf_document.h"

namespace foci {

/// The file (.gltf or .glb) with
///
///   floats in place of the integers of positions, normals, tangents and texture coordinates (core
///   glTF, KHR_mesh_quantization), which Assimp takes for the bytes of floats;
///   a node for each instance of EXT_mesh_gpu_instancing;
///   the image of EXT_texture_webp as the image of a texture that has no other;
///   the shape of morph targets and skins in the meshes themselves (gltf_shape.h);
///   no byte order mark.
///
/// Empty if nothing has to change, and for a file that is not UTF-8 or lacks a buffer: Assimp says
/// so.
/// @throws InputError if an accessor reaches beyond its buffer, a skin or a morph target cannot be
/// read, or a node has too many instances
std::string plainGltf(GltfDocument gltf);

}  // namespace foci
