// `.splat` files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(splat) {
  const auto file = foci::fuzz::asFile("input.splat", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isSplatFile(file);
    foci::readSplatFile(file);
  });
  return 0;
}
