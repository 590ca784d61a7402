// How the gaze of a live run has arrived: the sender's clock, and what was lost and when.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gaze/live/sender_clock.h"

namespace foci {

/// Gaze arrived during this time, and none of it was used.
struct UnusedGaze {
  double from_s = 0.0, to_s = 0.0;
  std::string why;
};

struct GazeReception {
  std::optional<ClockFacts> clock{};  ///< of the sender; absent: the samples have our times
  std::size_t dropped = 0;            ///< samples that arrived and were not given to the eye
  std::vector<UnusedGaze> unused{};   ///< longer than a second each
  /// "gaze arrives, but none of it has been used for 3 s: ..."; empty while gaze is used, or none
  /// arrives.
  std::string remark{};
};

}  // namespace foci
