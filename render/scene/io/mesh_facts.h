// What a mesh holds, besides its triangles. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <vector>

#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/triangle_mesh.h"

struct aiScene;

namespace foci {

/// Refuses a scene whose nodes repeat its meshes so often that applying their transforms would
/// exhaust the memory. @throws std::runtime_error
void refuseRepeats(const aiScene& scene);

/// Drops triangles that repeat others, with a remark. Sets the number of triangles, and where their
/// colours come from: of what the triangles use, not of all that the file lists.
void finishTriangles(TriangleMesh& mesh, SceneFacts& facts);

/// Which materials the meshes use. Files list others, and Assimp adds one to each glTF.
std::vector<bool> usedMaterials(const aiScene& scene);

/// The facts that Assimp's scene states: all but triangles, colours, positions and remarks.
SceneFacts meshFacts(const aiScene& scene, const std::filesystem::path& path);

}  // namespace foci
