// Reads points written as text: a point a line, its numbers between blanks, tabs, commas or
// semicolons. XYZ, TXT, ASC and PTS files look like this.
#pragma once

#include <filesystem>
#include <optional>

#include "render/scene/point_cloud.h"

namespace foci {

/// Whether the first line without a comment has three numbers or more, or a number of points, or
/// names x, y and z. False for a file that cannot be read.
bool startsWithPoints(const std::filesystem::path& path);

/// Reads points. Empty lines and those after `#` or `//` are skipped. A line with a single whole
/// number (PTS) is the number of points that follow. Columns are
///
///   by name, if a line before the points has names, also as a comment:
///     x y z, red green blue or r g b, nx ny nz, intensity; others are skipped. A unit in brackets
///     behind x, y and z counts: "X [mm]"
///   by their number otherwise:
///     3  x y z
///     4  x y z intensity
///     6  x y z, and colour or normal
///     7  x y z intensity colour after a number of points, x y z colour and a value otherwise
///     9  x y z, and colour and normal in any order
///
/// A triple is a normal if its length is 1 in every line (within 2 %; 0 is allowed), and a colour
/// otherwise; it is left out, with a remark, if it is 0 everywhere. Colours are sRGB, of 0 to 1, 0
/// to 255 or 0 to 65535, as their largest value needs. Without colours, intensity becomes grey
/// (scan_values.h).
///
/// Two layouts have names of their own: points3D.txt of COLMAP, where a track of any length follows
/// each point, and the points of Project Aria (px_world), of which those that are less certain than
/// 0.15 m, or 0.01 per metre of inverse distance, are left out.
/// @throws InputError with file and line
PointCloud readTextPoints(const std::filesystem::path& path);

/// The vertices of an OBJ, with colours of 0 to 1 where they have some. Absent if it has faces, or
/// no vertices.
/// @throws InputError with file and line
std::optional<PointCloud> readObjPoints(const std::filesystem::path& path);

}  // namespace foci
