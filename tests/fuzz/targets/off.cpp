// OFF meshes and points.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.off", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readOff(file); });
  return 0;
}
