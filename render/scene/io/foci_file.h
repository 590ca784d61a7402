// The `.foci` scene file: surfels or Gaussians that are ready to render.
//
// Little endian. A header of 64 bytes, then arrays.
//
//    0  8 bytes  "FOCI\r\n\x1a\n", which a transfer as text would alter
//    8  uint32   version: 4 surfels, 2 Gaussians
//   12  uint32   flags; others 0
//   16  uint64   surfels or Gaussians
//   24  uint64   bytes of the whole file
//   32  uint64   checksum of the bytes after the header
//   40  uint64   version 4: boxes; else 0
//   48  uint64   version 4: bytes of the names; else 0
//   56  uint64   checksum of bytes 0 to 55
//
// Surfels. Flags: 1 oriented, 2 with opacity, 4 samples of a mesh, 8 plain colours,
// 16 * (0 up axis unknown, 1 x, 2 y, 3 z), 64 with closed bodies, 128 with objects. In memory they
// lie as in the file, so foci renders from the mapped file and reads the pages that a frame needs.
// Each array begins at a multiple of 64, with zeros before. By surfel, in the order of the tree:
//       position_m 3 x float, axis_u_m 3, axis_v_m 3, color 3, area_m2 1, with opacity: opacity 1,
//       with closed bodies: 1 x uint16, the body's number from 1, or 0,
//       with objects: 1 x uint16, the object's number from 1, or 0
// then by node of the tree (render/lod/moment_tree.h), level by level from the root; the first
// entry is unused:
//       LodNode, Coarseness, with closed bodies: Facing
// then the boxes of the closed bodies, 6 x float each, and the names of the objects in UTF-8, each
// ended by a zero byte; the first of both is unused.
//
// Gaussians. Flags: 1 trained with a low-pass that preserves light, 2 y points down,
// 4 * degree of the harmonics. Without gaps; by Gaussian, in the order of the tree:
//   64  position_m 3 x float, covariance_m2 6, opacity 1, color 3,
//       harmonics 3 ((degree + 1)^2 - 1) x int16
// then the same by node of the tree, with three more arrays at the end: radius_m 1 x float,
// spread_m2 1, growth_per_m2 1. There are 2^`gaussianTreeLevels` nodes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/scene/io/foci_container.h"
#include "render/scene/scene.h"

namespace foci {

/// What the scene was prepared from, as far as rendering depends on it.
struct SurfelOrigin {
  bool mesh = false;             ///< samples of a mesh, so that none of them is a stray
  bool plain_colors = false;     ///< at most a colour for each material: no light is in them
  std::optional<int> up_axis{};  ///< 0 x, 1 y, 2 z
  bool y_is_down = false;        ///< the convention of cameras
  bool operator==(const SurfelOrigin&) const = default;
};

struct PreparedScene {
  Scene scene;
  SurfelOrigin origin{};
};

/// Whether the file begins like a scene file. False if the file cannot be read.
bool isSceneFile(const std::filesystem::path& path);

/// Writes a scene that is sound and not empty (asserted), Gaussians with their tree
/// (asserted). Surfels are written in the order of their tree.
/// @throws std::runtime_error if the file cannot be written
void writeSceneFile(const std::filesystem::path& path, const PreparedScene& scene);

/// Opens a scene through a memory map. Surfels with their tree stay in the file and are read as
/// they are used; everything else is read into memory. The scene is bit for bit the written one.
/// The file's content says what it holds.
///
/// A checksum finds any single altered byte, and other changes but for one in 2^64. Surfels must be
/// sound: finite positions and axes, axes longer than 0, areas > 0, colours >= 0, opacity 0 to 1.
/// So must Gaussians and nodes.
/// @param checked_B  the content of a larger file with surfels and their tree is not checked
/// @throws InputError for a file of another kind or of a later version, for one whose length
///         differs from its header, and for one that fails a check
PreparedScene readSceneFile(const std::filesystem::path& path,
                            std::uint64_t checked_B = kCheckedFile_B);

/// Writes a scene of surfels part by part, so that one part at a time is in memory.
class SurfelFileWriter {
 public:
  /// @param count       surfels of all parts, a multiple of 2^part_level
  /// @param part_level  there are 2^part_level parts, each below a node of this level of the tree;
  ///                    0 for a scene with closed bodies
  /// @param like        has the flags, boxes and names of the whole scene, and arrays where each
  ///                    part has them
  /// @throws std::runtime_error if the file cannot be written, as all functions here
  SurfelFileWriter(const std::filesystem::path& path, std::uint64_t count, int part_level,
                   const SurfelCloud& like, const SurfelOrigin& origin);
  void add(std::size_t part, const MomentTree& tree);
  /// After all parts.
  void finish();

 private:
  struct Layout {
    Layout(const SurfelCloud& like, const SurfelOrigin& origin, std::uint64_t count);

    FociHeader header;
    std::vector<std::uint64_t> sizes;
    std::size_t nodes_at = 0;  // the array of the nodes
  };
  void writeNodes(std::size_t first, const TreeNodes& nodes, std::size_t from, std::size_t count);

  std::uint64_t count_;
  int part_level_;
  std::vector<TreeRoot> roots_;
  Layout layout_;
  FociWriter writer_;
};

}  // namespace foci
