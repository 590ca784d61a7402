// Points of the Point Cloud Library.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(pcd) {
  const auto file = foci::fuzz::asFile("input.pcd", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readPcd(file); });
  return 0;
}
