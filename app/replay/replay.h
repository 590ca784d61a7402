// `foci replay`: a recorded gaze goes in, what the eye would have seen comes out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/record/manifest.h"
#include "app/replay/run_writer.h"
#include "app/study/study.h"
#include "render/scene/scene.h"

namespace foci {

/// The scene of a study, read when it is first needed. The runs of one study share it.
class ReplayedScene {
 public:
  /// @param file  the study's scene file, if it has been read
  explicit ReplayedScene(std::optional<SceneFile> file = {}) : file_(std::move(file)) {}

  /// @param warnings  of a run, which get those of the scene
  /// @throws InputError
  const Scene& of(const Study& study, Warnings& warnings);

  /// Files that runs have read, with their hashes: the next run need not hash them again.
  std::vector<InputFile> hashed{};

 private:
  std::optional<SceneFile> file_;
  std::optional<Scene> scene_{};
  std::vector<std::string> warnings_{};  // of the scene
};

/// Replays the study and writes its files (`RunWriter::files`) to `out`. If it throws, it leaves no
/// file there, and removes the folder if that is new.
/// @param command  as typed, for the manifest
/// @param threads  in use, for the manifest
/// @param heatmap  PLY of the scene with attention to write, too
/// @throws InputError, std::runtime_error
RunResult replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                 unsigned threads, ReplayedScene& scene, const OutputGuard& guard,
                 const std::optional<std::filesystem::path>& heatmap = {});

/// The same for a study whose scene nothing else needs, into a folder without foreign files.
RunResult replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                 unsigned threads);

}  // namespace foci
