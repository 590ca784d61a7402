// Samples points evenly over the triangles of a mesh.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/point_cloud.h"

namespace foci {

struct MeshSampling {
  /// About; 1 to 10^8. Absent: `defaultPoints`.
  std::optional<std::size_t> points = {};
};

/// As many points as show the mesh's detail: its triangles across (the median of their least
/// heights, which is the distance of the vertices where triangles are not thin) and the texels of
/// its textures. A screen on which the mesh just fills `kScreenRows` rows bounds the detail that
/// can be seen: one point a pixel. At least half of the triangles and `kMinPoints`, at most
/// `kMaxPoints`.
std::size_t defaultPoints(const TriangleMesh& mesh);

inline constexpr std::size_t kMinPoints = 500'000, kMaxPoints = 8'000'000;
inline constexpr double kScreenRows = 1080.0;

/// Samples points (poisson_disk.h). A small connected part is looked at from nearby: it has at
/// least a point a pixel where it fills 200 rows of a screen, as far as the wanted number or four
/// times the default allow. Normals are the triangles'. Colours are averaged over the point's
/// surroundings. There are no points where a texture cuts a hole.
/// @param name  of the mesh, for messages
/// @throws InputError if the mesh has too little area for its extent, or is cut out everywhere
PointCloud sampleMesh(const TriangleMesh& mesh, const std::filesystem::path& name,
                      const MeshSampling& sampling = {});

}  // namespace foci
