// PLY point clouds, in and out (Turk 1994: ASCII, binary little endian, binary big endian).
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Points as they were measured, as a structure of arrays. `position_m` and `color` have one entry
/// a point; each of the others has one a point or, where nobody said, none at all.
struct PointCloud {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> normal;  ///< unit length; (0, 0, 0): to be estimated
  std::vector<glm::vec3> color;   ///< linear RGB; mid-grey where the file has none
  std::vector<float> radius_m;  ///< of a disc that reaches across the gaps, > 0; 0: to be estimated
  std::vector<float> opacity;   ///< 0 to 1
  std::size_t dropped = 0;      ///< points left out since their position was not finite

  std::size_t size() const { return position_m.size(); }
};

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
