// `foci replay`: a recorded gaze goes in, what the eye would have seen comes out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/record/manifest.h"
#include "app/replay/run_writer.h"
#include "app/study/study.h"
#include "render/methods/method.h"
#include "render/scene/io/open_scene.h"
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

struct ImageRequest {
  std::filesystem::path out;                                      ///< .png, .pfm or .exr
  std::optional<std::filesystem::path> depth = {}, defocus = {};  ///< maps, .pfm or .exr
  /// Focus in dioptres (0: infinity); absent: the study's fixed focus, else the surface at the
  /// gaze. The eye focuses as near to it as its age and its refraction allow.
  std::optional<double> focus_D;
  /// On the study's screen, px; absent: `Session::middleSurface_px`.
  std::optional<glm::dvec2> gaze_px;
  OutputGuard guard = {};
};

struct ImageSummary {
  double focus_D = 0.0;
  std::optional<double> surface_distance_m;  ///< at the gaze; absent if there is none
  double pupil_mm = 0.0;
  std::string device;  ///< as `Session::devices`
  RenderStats stats;
  std::vector<std::string> warnings{};  ///< printed already
};

/// Renders the frame of a replay whose observer has looked at one point for a long time, at the
/// beginning of the recording. A still image has no frame-time budget. No recording is read: a
/// pupil from the recording has the study's fixed diameter, and one from luminance has adapted.
/// @param scene  the study's scene file, if it has been read
/// @throws InputError, std::runtime_error
ImageSummary renderImage(const Study& study, const ImageRequest& request,
                         std::optional<SceneFile> scene = {});

}  // namespace foci
