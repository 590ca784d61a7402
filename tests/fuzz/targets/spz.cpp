// SPZ files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.spz", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readSpz(foci::FileBytes(file)); });
  return 0;
}
