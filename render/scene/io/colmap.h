// The sparse points of COLMAP in binary (points3D.bin; COLMAP, Output Format). The text of the same
// name is points as text (text_points.h).
#pragma once

#include <filesystem>

#include "render/scene/point_cloud.h"

namespace foci {

/// Whether the file's first points are sound: it has no mark of its own.
bool isColmapFile(const std::filesystem::path& path);

/// Positions and colours. @throws InputError with the number of the point
PointCloud readColmap(const std::filesystem::path& path);

}  // namespace foci
