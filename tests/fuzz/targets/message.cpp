// Messages from the network. The input is the topic up to the first NUL, and the payload behind it.
#include <cstring>
#include <string_view>

#include "calibration/gaze_map/map_units.h"
#include "gaze/live/pupil_source.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(message) {
  const void* nul = size > 0 ? std::memchr(bytes, 0, size) : nullptr;
  if (nul == nullptr) return 0;
  const std::string_view all(reinterpret_cast<const char*>(bytes), size);
  const auto topic = static_cast<std::size_t>(static_cast<const std::uint8_t*>(nul) - bytes);
  foci::fuzz::readWithinLimits(size, [&] {
    foci::parsePupilMessage(all.substr(0, topic), all.substr(topic + 1), foci::defaultScreen());
  });
  return 0;
}
