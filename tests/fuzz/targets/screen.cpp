// Screen geometry: our own files and PsychoPy monitors.
#include "calibration/screen/screen_file.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(screen) {
  const auto file = foci::fuzz::asFile("screen", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readScreen(file); });
  return 0;
}
