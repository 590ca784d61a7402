// Scenes in the .foci format.
#include "render/scene/io/foci_file.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(foci_file) {
  const auto file = foci::fuzz::asFile("input.foci", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readSceneFile(file); });
  return 0;
}
