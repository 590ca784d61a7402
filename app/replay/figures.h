// Figures of a finished run for papers: `foci figures`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/figure.h"
#include "app/graphics/video_writer.h"
#include "app/platform/output_guard.h"
#include "app/replay/report_charts.h"
#include "app/study/study.h"
#include "gaze/sources/rows.h"

namespace foci {

// A finished run's folder, read back: tables, study, frames of the video.

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

/// The kinds; also the names of the files.
inline constexpr std::array<const char*, 5> kFigures{"scanpath", "gaze-map", "heat-map",
                                                     "time-series", "focus"};

struct FigureChoice {
  FigureStyle style{};               ///< pictures are as high as they need
  std::vector<std::string> kinds{};  ///< empty: all
  std::optional<std::string> trial{};
};

struct FiguresMade {
  std::vector<std::filesystem::path> files{};
  std::vector<std::string> remarks{};  ///< what the figures lack, one line each
};

std::vector<std::filesystem::path> figureFiles(const FigureChoice& choice,
                                               const std::filesystem::path& out);

/// Where a fixation lies on the frame of the scanpath, px of the study's screen.
struct PathPoint {
  glm::dvec2 at_px;
  double duration_s;
  std::size_t number;  ///< as in fixations.tsv
};

/// scanpath: circles at the fixations, whose area is the duration and whose colour the order.
/// @param frame  absent: white ground
GnuplotChart scanpathFigure(const FigureStyle& style, const Screen& screen,
                            const std::optional<Image>& frame, const std::vector<PathPoint>& path);

/// Time of fixation per solid angle at a direction: each fixation of duration t adds
///   t / (2 pi s^2) exp(-a^2 / (2 s^2)),   s = kGazeMapSigma_deg,
/// at the angle a from it (Le Meur and Baccino 2013, Eq. 2, with s the radius of the fovea).
/// @return row by row, s/deg2
std::vector<float> gazeMap(const Screen& screen, const glm::ivec2& size,
                           const std::vector<PathPoint>& path);
inline constexpr double kGazeMapSigma_deg = 1.0;

/// Writes the figures. Without `kinds`, a figure whose sources are gone is left out with a remark.
/// @throws InputError
FiguresMade writeFigures(const std::filesystem::path& run, const FigureChoice& choice,
                         const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
