// Sparse points of COLMAP.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("points3D.bin", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isColmapFile(file);
    foci::readColmap(file);
  });
  return 0;
}
