// Reads and writes PLY point clouds (Turk 1994): ASCII, binary little endian, binary big endian.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "render/scene/point_cloud.h"

namespace foci {

/// Reads the `vertex` element. Its properties may come in any order and of any scalar type, and
/// their names in any case. Other properties, lists and elements are skipped. The reader uses
///
///   x y z                                     required
///   nx ny nz                                  of any length; zero or not finite: estimated
///   red green blue | r g b | diffuse_red ...  sRGB; integers of the full range, floats 0 to 1
///   intensity | scalar_intensity              grey, if there is no colour, or all are 0
///   radius                                    metres
///   opacity | alpha | a beside r g b          integers of the full range, floats 0 to 1
///   label | class | object_id | scalar_label  integers: the point's object
///
/// The length is checked before memory is allocated.
/// @throws InputError with file and line (header, ASCII) or byte (binary), if the file is no PLY,
///         has no points, or is shorter than its header says
PointCloud readPly(const std::filesystem::path& path);

namespace ply {
class Items;
}

/// The points of a vertex element, as `readPly` reads them.
PointCloud readVertices(ply::Items& items, const std::string& file);

/// A further property of the points.
struct PlyProperty {
  std::string name;
  std::span<const float> values;  ///< by point; empty: no property
};

/// Writes binary little endian: float positions, the cloud's other arrays, and colours as 8-bit
/// sRGB.
/// @throws std::runtime_error if the file cannot be written
void writePly(const std::filesystem::path& path, const PointCloud& points,
              const PlyProperty& further = {});

}  // namespace foci
