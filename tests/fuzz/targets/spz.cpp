// SPZ files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(spz) {
  const auto file = foci::fuzz::asFile("input.spz", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readSpz(foci::FileBytes(file)); });
  return 0;
}
