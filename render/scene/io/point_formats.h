// The formats of points, one reader each (PLY: ply.h). Every reader throws InputError with one
// line, with file and line where the file is text.
#pragma once

#include <filesystem>
#include <string_view>
#include <variant>

#include "render/scene/io/scene_facts.h"
#include "render/scene/point_cloud.h"

namespace foci {

/// LAS scans (ASPRS LAS 1.0 to 1.4, point formats 0 to 10), uncompressed: positions, and colours
/// where the point format has them (16 bits; 8 bits if no channel exceeds 255). Otherwise, or if
/// all colours are 0, intensity becomes grey (scan_values.h). The z axis points upwards. Units and
/// longitudes are those of the file's coordinate system (las_coordinates.h).
PointCloud readLas(const std::filesystem::path& path);

/// Points of the Point Cloud Library (PCD, version 0.7): `ascii`, `binary` and `binary_compressed`.
/// Used are x y z, normal_x normal_y normal_z (or nx ny nz), rgb or rgba packed into four bytes,
/// r g b, intensity and label; other fields are skipped. The viewpoint is not applied.
bool isPcd(std::string_view start);
PointCloud readPcd(const std::filesystem::path& path);

/// Positions and colours of COLMAP's sparse points in binary (points3D.bin), recognised by its
/// first points. The text of the same name is points as text.
bool isColmapFile(const std::filesystem::path& path);
PointCloud readColmap(const std::filesystem::path& path);

/// Geomview's OFF, as CGAL and ModelNet write it too: a mesh, or points if the file has no faces.
/// Read are text with or without the word "OFF", normals (NOFF), colours of vertices (COFF) and of
/// faces. Colours are sRGB, of 0 to 1 or 0 to 255; numbers of a colour map are skipped.
std::variant<PointCloud, MeshFile> readOff(const std::filesystem::path& path);

/// Whether the first line without a comment has three numbers or more, or a number of points, or
/// names x, y and z. False for a file that cannot be read.
bool startsWithPoints(const std::filesystem::path& path);

/// Points as text (XYZ, TXT, ASC, PTS): a point a line, its numbers between blanks, tabs, commas or
/// semicolons. Empty lines and those after `#` or `//` are skipped. A line with a single whole
/// number (PTS) is the number of points that follow. Columns are
///
///   by name, if a line before the points has names, also as a comment:
///     x y z, red green blue or r g b, nx ny nz, intensity; others are skipped. A unit behind x, y
///     and z counts: "X [mm]", "x_mm"
///   by their number otherwise:
///     3  x y z
///     4  x y z intensity
///     6  x y z, and colour or normal
///     7  x y z intensity colour after a number of points, x y z colour and a value otherwise
///     9  x y z, and colour and normal in any order
///
/// A triple is a normal if its length is 1 in every line (within 2 %; 0 is allowed), and a colour
/// otherwise; it is left out, with a remark, if it is 0 everywhere. Colours are sRGB, of 0 to 1, 0
/// to 255 or 0 to 65535, as their largest value needs. Without colours, intensity becomes grey.
///
/// Two layouts have names of their own: points3D.txt of COLMAP, where a track of any length follows
/// each point, and the points of Project Aria (px_world), of which those that are less certain than
/// 0.15 m, or 0.01 per metre of inverse distance, are left out.
PointCloud readTextPoints(const std::filesystem::path& path);

}  // namespace foci
