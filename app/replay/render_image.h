// `foci render`: one image at a given focus or gaze.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/study/study.h"
#include "render/methods/method.h"
#include "render/scene/io/open_scene.h"

namespace foci {

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
