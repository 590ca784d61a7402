// Streams of the Lab Streaming Layer (github.com/sccn/liblsl), alive or in an XDF file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// What the header of a stream says: the XML of the Lab Streaming Layer, alive or in a file.
struct LslStream {
  std::string name{}, type{}, format{};
  std::size_t channels = 0;
  double rate_Hz = 0.0;                          ///< nominal; 0: irregular
  bool of_scene_camera = false;                  ///< pixels of its image (Neon)
  std::vector<std::string> columns{"time [s]"};  ///< and the channels' labels with their units

  bool hasTexts() const { return format == "string" && channels > 0; }
  bool hasNumbers() const { return format != "string" && channels > 0; }
  /// A stream of texts, or of numbers that come now and then, whose type is "Markers".
  bool isMarkers() const;
  /// A stream of numbers whose type or name has "gaze" or "eye" in it.
  bool isGaze() const;
};

/// @param file  for errors
/// @throws InputError unless it has up to 1024 channels
LslStream lslStreamOf(std::string_view xml, const std::string& file);

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
