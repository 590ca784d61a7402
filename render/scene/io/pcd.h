// Points of the Point Cloud Library (PCD, version 0.7; pointclouds.org, The PCD file format).
#pragma once

#include <filesystem>
#include <string_view>

#include "render/scene/point_cloud.h"

namespace foci {

/// Whether a text begins like a PCD file.
bool isPcd(std::string_view start);

/// Reads `ascii`, `binary` and `binary_compressed`. Used are x y z, normal_x normal_y normal_z (or
/// nx ny nz), rgb or rgba packed into four bytes, r g b, intensity and label; other fields are
/// skipped. The viewpoint is not applied.
/// @throws InputError with the line of the header, or of the points as text
PointCloud readPcd(const std::filesystem::path& path);

}  // namespace foci
