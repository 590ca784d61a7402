// SOG files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(sog) {
  const auto file = foci::fuzz::asFile("input.sog", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isSogFile(file);
    foci::readSogFile(file);
  });
  return 0;
}
