// Times of a stream of the Lab Streaming Layer on the recorder's clock, after pyxdf (Boulay and
// others, github.com/xdf-modules/pyxdf): split at resets of the stream's clock, a robust line
// through the clock offsets of each part, even intervals.
#pragma once

#include <vector>

namespace foci {

/// A measurement as an XDF file stores it.
struct ClockOffset {
  double collected_s = 0.0;  ///< when it was made, on the stream's clock
  double offset_s = 0.0;     ///< the recorder's clock minus the stream's
};

/// Adds the offset to each time. A stream whose clock was reset during the recording has a line for
/// each part; times change to a later part where they jump by more than a second.
/// @param times_s  in the file's order
/// @return the number of resets
/// @throws std::invalid_argument if the offset changes by half a second in a second or more
int toRecorderClock(std::vector<double>& times_s, const std::vector<ClockOffset>& offsets);

/// Puts the times of a regular stream at even intervals: the line by least squares through each
/// stretch without a gap. A stretch whose intervals are not even keeps its times.
void removeJitter(std::vector<double>& times_s);

}  // namespace foci
