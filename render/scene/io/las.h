// Reads LAS scans (ASPRS LAS 1.0 to 1.4, point formats 0 to 10), uncompressed.
#pragma once

#include <filesystem>

#include "render/scene/point_cloud.h"

namespace foci {

/// Reads positions, and colours where the point format has them (16 bits; 8 bits if no channel
/// exceeds 255). Otherwise, or if all colours are 0, intensity becomes grey (scan_values.h). The z
/// axis points upwards. Units and longitudes are those of the file's coordinate system
/// (las_coordinates.h).
/// @throws InputError if the file is compressed (LAZ), is no LAS file, has no points, or is shorter
///         than its header says
PointCloud readLas(const std::filesystem::path& path);

}  // namespace foci
