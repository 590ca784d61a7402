// LAS scans.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(las) {
  const auto file = foci::fuzz::asFile("input.las", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readLas(file); });
  return 0;
}
