// The `.foci` scene file: surfels or Gaussians that are ready to render.
//
// Little endian. A header of 64 bytes, then arrays without gaps.
//
//    0  8 bytes  "FOCI\r\n\x1a\n", which a transfer as text would alter
//    8  uint32   version: 1 surfels, 2 Gaussians, 3 surfels with bodies or objects
//   12  uint32   flags; others 0
//   16  uint64   surfels or Gaussians
//   24  uint64   bytes of the whole file
//   32  uint64   checksum of the bytes after the header
//   40  16 bytes of 0
//   56  uint64   checksum of bytes 0 to 55
//
// Surfels. Flags: 1 oriented, 2 with opacity, 4 samples of a mesh, 8 plain colours,
// 16 * (0 up axis unknown, 1 x, 2 y, 3 z), 64 with closed bodies, 128 with objects. By surfel:
//   64  position_m 3 x float, axis_u_m 3, axis_v_m 3, color 3, area_m2 1, with opacity: opacity 1,
//       with closed bodies: 1 x uint16, the body's number from 1, or 0,
//       with objects: 1 x uint16, the object's number from 1, or 0
// With objects, then their names in UTF-8, each ended by a zero byte; the first is empty.
//
// Gaussians. Flags: 1 trained with a low-pass that preserves light, 2 y points down,
// 4 * degree of the harmonics. By Gaussian, in the order of the tree:
//   64  position_m 3 x float, covariance_m2 6, opacity 1, color 3,
//       harmonics 3 ((degree + 1)^2 - 1) x int16
// then the same by node of the tree, with three more arrays at the end: radius_m 1 x float,
// spread_m2 1, growth_per_m2 1. There are 2^`gaussianTreeLevels` nodes.
#pragma once

#include <filesystem>
#include <optional>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// What the scene was prepared from, as far as it tells how to show them.
struct SurfelOrigin {
  bool mesh = false;             ///< samples of a mesh, so that none of them is a stray
  bool plain_colors = false;     ///< at most a colour for each material: no light is in them
  std::optional<int> up_axis{};  ///< 0 x, 1 y, 2 z
  bool y_is_down = false;        ///< of Gaussians: the convention of cameras
  bool operator==(const SurfelOrigin&) const = default;
};

struct PreparedScene {
  SurfelCloud cloud;
  SurfelOrigin origin{};
};

/// Whether the file begins like a scene file. False if the file cannot be read.
bool isSceneFile(const std::filesystem::path& path);

/// Writes a scene whose cloud is sound and not empty (asserted), Gaussians with their tree
/// (asserted).
/// @throws std::runtime_error if the file cannot be written
void writeSceneFile(const std::filesystem::path& path, const PreparedScene& scene);

/// Reads through a memory map, and checks everything before it allocates the scene, which is bit
/// for bit the written one. The file's content says what it holds.
/// @throws InputError for a file of another kind or of a later version, and for one whose length
///         differs from its header. A checksum finds any single altered byte, and other changes but
///         for one in 2^64. Surfels must be sound: finite positions and axes, axes longer than 0,
///         areas > 0, colours >= 0, opacity 0 to 1. So must Gaussians and nodes.
PreparedScene readSceneFile(const std::filesystem::path& path);

}  // namespace foci
