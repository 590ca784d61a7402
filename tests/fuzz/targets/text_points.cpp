// Points as text. The first byte chooses the extension.
#include "render/scene/io/point_formats.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(text_points) {
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"input.xyz", "input.pts", "input.txt"};
  const auto file = foci::fuzz::asFile(kNames[bytes[0] % 3], bytes + 1, size - 1);
  foci::fuzz::readWithinLimits(size, [&] {
    if (foci::startsWithPoints(file)) foci::readTextPoints(file);
  });
  return 0;
}
