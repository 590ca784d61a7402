// What a replay reads. Reading it all refuses bad input before anything is written.
#pragma once

#include <atomic>
#include <cstddef>
#include <future>
#include <vector>

#include "app/platform/warnings.h"
#include "app/record/manifest.h"
#include "app/record/record_files.h"
#include "app/study/session_settings_of.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/surfel_cloud.h"

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

/// A recording and what happened during it.
struct ReplayedGaze {
  Study study;  ///< with the recording's head (`withRecordedHead`) and the schedule's rate
  GazeTrace trace;
  Schedule schedule;
  std::vector<Change> changes;
  std::vector<TraceTrial> trials;
};

/// @throws InputError, also for images that H.264 does not take
ReplayedGaze readReplayedGaze(const Study& study, Warnings& warnings);

/// The input files of a study with their hashes, which are computed while the frames are rendered:
/// a large scene takes longer than its first frame. The files are opened at once, so that their
/// names may vanish meanwhile.
class InputHashes {
 public:
  /// @param known  files whose hashes are known
  /// @throws InputError if a file cannot be read
  explicit InputHashes(const Study& study, std::vector<InputFile> known = {});
  /// Stops the work.
  ~InputHashes();
  InputHashes& operator=(InputHashes&&) = delete;  // nor copied

  /// Waits for them. Call it once.
  /// @throws InputError, std::runtime_error after a signal
  std::vector<InputFile> get();

 private:
  std::atomic<bool> stop_ = false;
  std::future<std::vector<InputFile>> files_{};
};

}  // namespace foci
