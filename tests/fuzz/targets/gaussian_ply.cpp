// PLY files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(gaussian_ply) {
  const auto file = foci::fuzz::asFile("input.ply", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readGaussianPly(file); });
  return 0;
}
