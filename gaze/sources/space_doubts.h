// What looks wrong in gaze in space: a wrong frame, axis, unit or order of columns still gives
// lines of sight, so nobody would notice it in a result.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Gathers samples in constant memory, then names the doubts.
class SpaceDoubts {
 public:
  void add(const GazeSample& sample);

  /// One sentence for each doubt, with the key to set.
  /// @param in_world  the frame of the gaze columns, as stated
  /// @param y_is_up   in the recording's world; false: unknown
  std::vector<std::string> sentences(bool in_world, bool y_is_up) const;

 private:
  std::vector<std::string> gazeDoubts(bool in_world) const;
  std::vector<std::string> headDoubts(bool y_is_up) const;
  std::vector<std::string> eyeDoubts() const;

  std::size_t samples_ = 0, gazes_ = 0, behind_ = 0, beside_ = 0, stride_ = 1;
  std::vector<GazeSample> kept_{};  // every `stride_`-th, at most kMaxKept
};

}  // namespace foci
