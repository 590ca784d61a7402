// The one rule against silence: whenever gaze arrives, but none of it is used for more than a
// second, this says so and why. Window, log, record and the answers to the sender show its remark.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/record/gaze_reception.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

class GazeWatch {
 public:
  /// Gaze has arrived.
  /// @param samples  that the eye gets
  /// @param dropped  how many others there were
  /// @param why      the latest of those was dropped
  /// @return a line for the log; "" mostly
  std::string arrive(double now_s, const std::vector<GazeSample>& samples, std::size_t dropped,
                     const std::string& why);

  /// A frame has looked at the gaze.
  /// @param uses_gaze  the eye has a state that comes of gaze
  /// @return a line for the log; "" mostly
  std::string look(double now_s, bool uses_gaze);

  std::size_t dropped() const { return all_dropped_; }
  const std::vector<UnusedGaze>& unused() const { return unused_; }
  const std::string& remark() const { return remark_; }

 private:
  std::string reasons(double now_s) const;

  bool looked_ = false;              // there was a frame: before it, the scene is still loading
  double looked_s_ = 0.0;            // at the latest frame
  bool unused_now_ = false;          // since `since_s_`
  std::optional<double> since_s_{};  // gaze has arrived and not been used
  std::size_t dropped_ = 0, pointless_ = 0, pointed_ = 0;  // of it
  double oldest_s_ = 0.0;                                  // on arrival, of those with a point
  std::string why_{};
  std::optional<double> logged_s_{};  // end of the latest time that was logged
  bool logs_ = false;                 // this time is logged
  std::size_t all_dropped_ = 0;
  std::vector<UnusedGaze> unused_{};
  std::string remark_{};
};

}  // namespace foci
