// How good a calibration is: accuracy, precision and data loss, by target and overall (gaze.md).
#pragma once

#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/gaze_pairs.h"

namespace foci {

/// As EyeLink users know them: good below 1 deg mean and 1.5 deg worst target, fair to 1.5 and 2.
enum class Grade { good, fair, poor };
std::string_view nameOf(Grade grade);

/// Absent where no sample, or for precision no pair of samples, is left to measure it.
struct GazeMeasures {
  std::size_t samples = 0;  ///< rows, lost ones included
  std::size_t lost = 0;
  std::optional<double> accuracy_deg{};  ///< mean angle between gaze and target
  std::optional<double>
      rms_s2s_deg{};  ///< sqrt(sum theta(g_i, g_i+1)^2 / pairs), pairs of adjacent rows
  std::optional<double>
      sd_deg{};  ///< sqrt(sum theta(g_i, mean)^2 / n), mean of the target's samples
  std::optional<double> uncertainty_deg{};  ///< mean of what the map states
  std::optional<double> within{};           ///< share of the errors within what the map states
};

struct TargetMeasures {
  glm::dvec2 target{0.0};
  GazeMeasures measures{};
  std::optional<glm::dvec2> mean{};  ///< of the gaze, in the frame's units
};

struct GazeAccuracy {
  GazeMeasures overall;
  std::optional<double> worst_deg{};    ///< accuracy at the worst target
  std::vector<TargetMeasures> targets;  ///< in order of first appearance
};

/// Gaze is mapped by `map`, or taken as it is where there is none.
GazeAccuracy measureAccuracy(std::span<const GazePair> pairs, const GazeFrame& frame,
                             const GazeMap* map);

/// `poor` where nothing could be measured.
Grade gradeOf(const GazeAccuracy& accuracy);

}  // namespace foci
