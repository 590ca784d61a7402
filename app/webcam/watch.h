// Shows what the webcam tracker sees: a table with a row for each frame, and the frames with the
// face drawn over them.
#pragma once

#include <string>

namespace foci {

struct WatchOptions {
  std::string source{};   ///< a camera's number, a video, a picture or a pattern
  std::string out{};      ///< the table; empty: standard output
  std::string overlay{};  ///< .mp4, or .png for one picture; may be empty
  std::string camera{};   ///< file of a calibrated camera; may be empty
  bool table = true;      ///< false: only the summary
  bool json = false, overwrite = false;
};

/// A camera is watched until an interrupt, a file to its end.
/// @throws InputError
void watchWebcam(const WatchOptions& options);

}  // namespace foci
