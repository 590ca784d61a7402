// `.ksplat` files of Gaussians.
#include "render/scene/io/gaussian_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.ksplat", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isKsplatFile(file);
    foci::readKsplatFile(file);
  });
  return 0;
}
