// What a replay reads. Reading it all refuses bad input before anything is written.
#pragma once

#include <atomic>
#include <filesystem>
#include <future>
#include <optional>
#include <vector>

#include "app/platform/warnings.h"
#include "app/record/manifest.h"
#include "app/record/record_files.h"
#include "app/replay/schedule.h"
#include "app/study/live_change.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

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
  InputHashes(const InputHashes&) = delete;
  InputHashes& operator=(const InputHashes&) = delete;

  /// Waits for them. Call it once.
  /// @throws InputError, std::runtime_error after a signal
  std::vector<InputFile> get();

 private:
  std::atomic<bool> stop_ = false;
  std::future<std::vector<InputFile>> files_{};
};

}  // namespace foci
