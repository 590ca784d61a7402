// `foci replay STUDY --trace A B C`: the same study for many recordings, with one page and one
// table over all of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/replay/replay.h"
#include "app/study/study.h"

namespace foci {

/// A recording of a batch, and the folder of its run.
struct BatchRecording {
  std::string trace;  ///< as typed
  std::string name;   ///< of the folder, without its parents
  Study study{};      ///< of this recording, checked
};

/// Names a folder for each recording after its file. Files of one name get their folder's name
/// before it: `sub-01-gaze`. Characters that no folder should have become `_`. The names differ by
/// more than the case of their letters.
/// @throws InputError if a recording is given twice
std::vector<std::string> folderNames(const std::vector<std::string>& traces);

/// The same for the names that the recordings have: each becomes a folder of its own.
void nameSafely(std::vector<BatchRecording>& recordings);

/// The files that `replayAll` writes.
std::vector<std::filesystem::path> batchFiles(const std::vector<BatchRecording>& recordings,
                                              const std::filesystem::path& out);

/// A recording and what came of it.
struct BatchResult {
  BatchRecording recording;
  RunResult run{};
  std::string problem{};   ///< why there is no run; empty: there is one
  bool bad_input = false;  ///< the problem is the input's
};

/// Replays each recording into a folder of its own, then writes index.html and recordings.tsv. A
/// recording that fails does not stop the others; both name its problem.
/// @throws InputError if another run writes to `out`; std::runtime_error
std::vector<BatchResult> replayAll(const std::vector<BatchRecording>& recordings,
                                   const std::filesystem::path& out, const std::string& command,
                                   unsigned threads, ReplayedScene& scene,
                                   const OutputGuard& guard);

/// recordings.tsv: one row for each recording, `n/a` where it has no run.
std::string recordingsTable(const std::vector<BatchResult>& results);

/// index.html: an image of each run, and a link to its report.
/// @param study  of any of the recordings
std::string recordingsPage(const Study& study, const std::vector<BatchResult>& results);

}  // namespace foci
