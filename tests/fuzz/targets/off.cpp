// OFF meshes and points.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(off) {
  const auto file = foci::fuzz::asFile("input.off", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readOff(file); });
  return 0;
}
