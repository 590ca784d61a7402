// Compressed PLY files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.ply", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readCompressedGaussianPly(file); });
  return 0;
}
