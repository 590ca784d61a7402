// Recordings in BIDS. The input is the JSON up to the first NUL, and the table behind it.
#include <cstring>

#include "calibration/gaze_map/map_units.h"
#include "gaze/sources/trace_reader.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(bids) {
  const void* nul = size > 0 ? std::memchr(bytes, 0, size) : nullptr;
  if (nul == nullptr) return 0;
  const auto json = static_cast<std::size_t>(static_cast<const std::uint8_t*>(nul) - bytes);
  foci::fuzz::asFile("input_physio.json", bytes, json);
  const auto file = foci::fuzz::asFile("input_physio.tsv.gz", bytes + json + 1, size - json - 1);
  foci::fuzz::readWithinLimits(size, [&] { foci::readTrace(file, {}, foci::defaultScreen()); });
  return 0;
}
