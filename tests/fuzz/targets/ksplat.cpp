// `.ksplat` files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(ksplat) {
  const auto file = foci::fuzz::asFile("input.ksplat", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isKsplatFile(file);
    foci::readKsplatFile(file);
  });
  return 0;
}
