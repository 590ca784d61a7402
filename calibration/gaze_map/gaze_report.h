// Quality of a gaze calibration: accuracy, precision and data loss, for each target and overall (as
// Holmqvist et al. 2012 define them). Reported as JSON for programs, as text and HTML for people.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/gaze_map/fit_gaze_map.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/map_units.h"

namespace foci {

/// EyeLink's limits for validation: good below 1 deg mean and 1.5 deg at the worst target, fair up
/// to 1.5 and 2 deg.
enum class Grade { good, fair, poor };
std::string_view nameOf(Grade grade);

/// A measure is absent where it has no sample, or for precision no pair of samples.
struct GazeMeasures {
  std::size_t samples = 0;               ///< rows, those without gaze included
  std::size_t missing = 0;               ///< rows without gaze: data loss
  std::optional<double> accuracy_deg{};  ///< mean angle between gaze and target
  std::optional<glm::dvec2> axes_deg{};  ///< mean error across and down
  /// sqrt(sum theta(g_i, g_i+1)^2 / pairs) over pairs of adjacent rows.
  std::optional<double> rms_s2s_deg{};
  /// sqrt(sum theta(g_i, mean)^2 / n), with the mean of the target's samples.
  std::optional<double> sd_deg{};
  std::optional<double> uncertainty_deg{};  ///< mean of the map's own estimates
  std::optional<double> within{};           ///< share of errors within those estimates
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

/// @param map  maps the gaze of `pairs`; nullptr: their gaze is mapped already
GazeAccuracy measureAccuracy(std::span<const GazePair> pairs, const GazeFrame& frame,
                             const GazeMap* map);

/// `poor` where nothing could be measured.
Grade gradeOf(const GazeAccuracy& accuracy);

struct GazeReport {
  GazeFit fit;
  GazeAccuracy accuracy;
  std::string model{};     ///< "webcam"; empty: fit.map.model
  bool validated = false;  ///< accuracy was measured on samples that the fit did not see
  std::vector<std::string> warnings{};  ///< printed already; without < and &
};

/// One JSON object with the keys model, samples, accuracy_deg, error_across_deg, error_down_deg,
/// accuracy_max_deg,
/// precision_rms_s2s_deg, precision_sd_deg, lost (share of data loss), grade, validated,
/// uncertainty_deg, within_uncertainty, slipped_targets, fit_ms, targets and warnings. A value that
/// could not be measured is null.
std::string gazeReportJson(const GazeReport& report);

/// A few lines and a table of the targets.
std::string gazeReportText(const GazeReport& report);

/// A web page that stands alone, with an image of the targets.
std::string gazeReportHtml(const GazeReport& report);

}  // namespace foci
