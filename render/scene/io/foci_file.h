// The project's own scene file: surfels ready to be drawn.
//
// Little endian. A header of 64 bytes, then arrays without gaps, each of `surfels` entries:
//    0  8 bytes  "FOCI\r\n\x1a\n", which a transfer as text would alter
//    8  uint32   version, 1
//   12  uint32   flags: 1 oriented, 2 with opacity; others 0
//   16  uint64   surfels
//   24  uint64   bytes of the whole file
//   32  uint64   checksum of what follows the header
//   40  16 bytes of 0
//   56  uint64   checksum of bytes 0 to 55
//   64  position_m 3 x float, axis_u_m 3, axis_v_m 3, color 3, area_m2 1, with opacity: opacity 1
#pragma once

#include <filesystem>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Whether the file begins as a scene file does. False where it cannot be read.
bool isSceneFile(const std::filesystem::path& path);

/// @throws std::runtime_error where the file cannot be written; `cloud` is sound and not empty
/// (asserted)
void writeSceneFile(const std::filesystem::path& path, const SurfelCloud& cloud);

/// Reads through a memory map. The same bytes come back that were written.
/// @throws InputError for what is not a scene file, is of a later version, cut short, longer than
/// it says,
///         altered anywhere (any single altered byte is found, others but for one in 2^64), or
///         holds surfels that are not sound: positions and axes finite, axes of some length, areas
///         > 0, colours >= 0, opacity 0 to 1. Found out before memory is taken.
SurfelCloud readSceneFile(const std::filesystem::path& path);

}  // namespace foci
