// The formats of meshes, one reader each (OFF: point_formats.h). Every reader throws InputError if
// the file is damaged, if no triangle has an area, or if a texture or a file of materials is a pipe
// or a device.
#pragma once

#include <filesystem>
#include <optional>
#include <variant>

#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/point_cloud.h"

namespace foci {

/// glTF 2.0, text or binary: nodes with instances, skins and morph targets; Draco and meshopt;
/// materials with metallic roughness, specular glossiness or no light.
/// @param points_are_kept  the caller shows them: they are not counted as left out
MeshFile readGltfMesh(const GltfDocument& gltf, bool points_are_kept = false);

/// The points and Gaussians of a glTF: primitives of mode 0 (glTF 2.0, 3.7.2), and
/// KHR_gaussian_splatting (Khronos, ratified 2026) with its compression by SPZ. In the frame of its
/// scene, metres.
struct GltfPoints {
  std::optional<GaussianFile> gaussians{};
  std::optional<PointCloud> points{};
  bool has_triangles = false;
};

/// Reads the points and Gaussians that the nodes of the scene place; triangles are not read.
/// @throws InputError if an attribute is missing, or cannot be read
GltfPoints readGltfPoints(const GltfDocument& gltf);

/// A mesh, or the vertices as points if the file has no faces.
std::variant<PointCloud, MeshFile> readObj(const std::filesystem::path& path);
MeshFile readStlMesh(const std::filesystem::path& path);

/// @throws InputError also if foci was built without Assimp
MeshFile readFbxMesh(const std::filesystem::path& path);

/// Whether a PLY file has faces or triangle strips.
bool isPlyMesh(const ply::Header& header);

/// Properties of vertices: those of points (ply.h) but radius and labels, and texture coordinates
/// (s t, u v, texture_u texture_v, ...). Of faces: vertex_indices, texcoord, texnumber (of the
/// comments TextureFile) and a colour, which counts if the vertices have none. Elements may come in
/// any order.
MeshFile readPlyMesh(const std::filesystem::path& path);

}  // namespace foci
