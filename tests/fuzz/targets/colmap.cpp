// Sparse points of COLMAP.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(colmap) {
  const auto file = foci::fuzz::asFile("points3D.bin", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isColmapFile(file);
    foci::readColmap(file);
  });
  return 0;
}
