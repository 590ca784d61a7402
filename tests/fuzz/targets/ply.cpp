// PLY point clouds, up to surfels.
#include "render/scene/open_scene.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("input.ply", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::openScene(file, 1.0, {}); });
  return 0;
}
