// What the first bytes say of a file: a format, or the right word for what is no scene.
#include "render/scene/io/open_scene.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(scene) {
  const auto file = foci::fuzz::asFile("input", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::isScene(file);
    const foci::FileStart start(file);
    foci::refusalOf(start, foci::formatOf(start));
  });
  return 0;
}
