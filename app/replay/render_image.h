// `foci render`: one image at a given focus or gaze.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/study/study.h"
#include "render/methods/method.h"

namespace foci {

struct ImageRequest {
  std::filesystem::path out;                   ///< .png, .pfm or .exr
  std::optional<std::filesystem::path> depth;  ///< .pfm
  /// Focus in dioptres (0: infinity); absent: what `gaze_px` shows. The eye focuses as near to it
  /// as its age and its refraction let it.
  std::optional<double> focus_D;
  /// On the study's screen, px; absent: its centre.
  std::optional<glm::dvec2> gaze_px;
};

struct ImageSummary {
  double focus_D = 0.0;
  std::optional<double> surface_distance_m;  ///< under the gaze; absent on a miss: focus rests
  double pupil_mm = 0.0;
  RenderStats stats;
};

/// The eye is where it is at the recording's beginning. No recording is read: where its pupil is
/// wanted, the study's fixed one is taken; that of the image's light is the adapted one.
/// @throws InputError, std::runtime_error
ImageSummary renderImage(const Study& study, const ImageRequest& request);

}  // namespace foci
