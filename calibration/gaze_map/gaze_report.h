// Reports of a gaze calibration: JSON for programs, text and HTML for people.
#pragma once

#include <string>
#include <vector>

#include "calibration/gaze_map/accuracy.h"
#include "calibration/gaze_map/fit_gaze_map.h"

namespace foci {

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
