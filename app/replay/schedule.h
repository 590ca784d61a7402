// The times at which a replay renders frames.
#pragma once

#include <cstddef>
#include <vector>

#include "app/record/record_files.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The frames of a replay, on the recording's clock.
struct Schedule {
  double first_s = 0.0;
  double fps = 0.0;
  std::size_t frames = 0;
  std::vector<RecordedFrame> recorded{};  ///< of a live run: the frames that the eye looks at
  std::size_t first = 0;                  ///< of the recorded frames, the first to be rendered

  double time_s(std::size_t frame) const {
    return recorded.empty() ? first_s + static_cast<double>(frame) / fps
                            : recorded[first + frame].time_s;
  }
  /// The frame knows the samples up to this time.
  double known_s(std::size_t frame) const {
    return recorded.empty() ? time_s(frame) : recorded[first + frame].known_s;
  }
  double end_s() const {
    return recorded.empty() ? time_s(frames) : time_s(frames - 1) + 1.0 / fps;
  }
};

/// Frames within `output.seconds`: those of a recorded live run at its mean rate, else `output.fps`
/// a second.
/// @throws InputError where there are none, or too many
Schedule scheduleOf(const Study& study, const GazeTrace& trace);

}  // namespace foci
