// Scenes in the .foci format.
#include "render/scene/io/foci_file.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.foci", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readSceneFile(file); });
  return 0;
}
