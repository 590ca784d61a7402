// Points of the Point Cloud Library.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.pcd", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readPcd(file); });
  return 0;
}
