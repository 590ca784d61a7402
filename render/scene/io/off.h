// Reads OFF files (Geomview's "Object File Format", as CGAL and ModelNet write it too).
#pragma once

#include <filesystem>
#include <variant>

#include "render/scene/io/mesh.h"
#include "render/scene/point_cloud.h"

namespace foci {

/// By its extension.
bool isOffFile(const std::filesystem::path& path);

/// Reads a mesh, or points if the file has no faces. Read are text with or without the word "OFF",
/// normals (NOFF), colours of vertices (COFF) and of faces. Colours are sRGB, of 0 to 1 or 0 to
/// 255; numbers of a colour map are skipped. Polygons become triangles.
/// @throws InputError with file and line; for binary files and more than three dimensions
std::variant<PointCloud, MeshFile> readOff(const std::filesystem::path& path);

}  // namespace foci
