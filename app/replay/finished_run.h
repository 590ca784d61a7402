// A finished run's folder, read back: tables, study, frames of the video.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"
#include "app/replay/report_charts.h"
#include "app/study/study.h"
#include "gaze/sources/rows.h"

namespace foci {

/// A frame of frames.tsv.
struct RunFrame : ChartRow {
  glm::dvec3 eye_m{0.0};
  std::string trial{};
  std::size_t number = 0;  ///< in the video
};

/// A row of fixations.tsv; NaN: absent.
struct RunFixation {
  std::size_t number = 0;
  double onset_s = 0.0, duration_s = 0.0;
  std::optional<glm::dvec2> gaze_px{};  ///< on the study's screen
  std::optional<glm::dvec3> point_m{};  ///< of the scene
  double surface_D = 0.0, focus_D = 0.0, blur_arcmin = 0.0;
  std::string trial{};
};

/// A table of a run's folder. @throws InputError that says what the folder should be
NamedTable tableOfRun(const std::filesystem::path& folder, const char* name);

/// @return not empty @throws InputError
std::vector<RunFrame> framesOfRun(const std::filesystem::path& folder);
std::vector<RunFixation> fixationsOfRun(const std::filesystem::path& folder);

/// The study that manifest.json holds. Names of files are those that the run was given.
/// @throws InputError
Study studyOfRun(const std::filesystem::path& folder);

/// Refuses inputs of the run that are gone or have changed since. @throws InputError
void requireSameInputs(const std::filesystem::path& folder);

/// Frames of the run's video.
/// @param wanted  their numbers, rising
/// @throws InputError
std::vector<Image> videoFrames(const std::filesystem::path& folder,
                               const std::vector<std::size_t>& wanted);

}  // namespace foci
