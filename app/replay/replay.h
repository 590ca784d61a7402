// `foci replay`: a recorded gaze goes in, what the eye would have seen comes out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/record/run_summary.h"
#include "app/study/study.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// The files in `out` that a replay of the study writes. Of images, the numbers are not known
/// before the run: these are the images that are there already.
std::vector<std::filesystem::path> replayFiles(const Study& study,
                                               const std::filesystem::path& out);

/// Replays the study and writes video.mp4, frames.tsv, events.tsv, manifest.json and report.html to
/// `out`. If it throws, it leaves no file there, and removes the folder if that is new.
/// @param command  as typed, for the manifest
/// @param threads  in use, for the manifest
/// @param scene    the study's scene file, if it has been read
/// @throws InputError, std::runtime_error
RunSummary replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                  unsigned threads, std::optional<SceneFile> scene = {});

}  // namespace foci
