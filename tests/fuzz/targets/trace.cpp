// Recordings as text, in the format of any tracker.
#include "calibration/gaze_map/map_units.h"
#include "gaze/sources/trace_reader.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(trace) {
  const auto file = foci::fuzz::asFile("input.tsv", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readTrace(file, {}, foci::defaultScreen()); });
  return 0;
}
