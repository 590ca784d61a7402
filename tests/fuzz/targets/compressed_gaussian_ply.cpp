// Compressed PLY files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(compressed_gaussian_ply) {
  const auto file = foci::fuzz::asFile("input.ply", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readCompressedGaussianPly(file); });
  return 0;
}
