// PLY point clouds, in and out (Turk 1994: ASCII, binary little endian, binary big endian).
#pragma once

#include <filesystem>

#include "render/scene/point_cloud.h"

namespace foci {

/// Reads the `vertex` element; its properties may come in any order and of any scalar type, other
/// properties, lists and elements are skipped. Taken are
///   x y z                                          (required)
///   nx ny nz                                       any length; zero or not finite: to be estimated
///   red green blue | r g b | diffuse_red ...       integers: sRGB of the type's full range;
///                                                  floats: sRGB, 0 to 1
///   radius                                         metres
///   opacity | alpha                                integers of the full range, floats 0 to 1
/// @throws InputError naming file and line (header, ASCII) or byte (binary) for what is no PLY, a
/// file
///         shorter than its header says (found out before any memory is taken), or no points at all
PointCloud readPly(const std::filesystem::path& path);

/// Writes binary little endian: float positions, and what else the cloud has; colours as 8-bit
/// sRGB.
/// @throws std::runtime_error where the file cannot be written
void writePly(const std::filesystem::path& path, const PointCloud& points);

}  // namespace foci
