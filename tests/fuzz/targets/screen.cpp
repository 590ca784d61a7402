// Screen geometry: our own files and PsychoPy monitors.
#include "calibration/screen/screen_file.h"
#include "tests/fuzz/harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = foci::fuzz::asFile("screen", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readScreen(file); });
  return 0;
}
