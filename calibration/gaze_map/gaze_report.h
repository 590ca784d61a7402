// The result of a gaze calibration, for people and for programs.
#pragma once

#include "calibration/gaze_map/accuracy.h"
#include "calibration/gaze_map/fit_gaze_map.h"

namespace foci {

struct GazeReport {
  GazeFit fit;
  GazeAccuracy accuracy;
  std::string model{};     ///< of a map that is none of fit.map.model; empty: that one
  bool validated = false;  ///< measured on other samples than the fit's
};

/// One JSON object: model, samples, accuracy_deg, accuracy_max_deg, precision_rms_s2s_deg,
/// precision_sd_deg, lost (share), and besides grade, uncertainty_deg, within_uncertainty, targets,
/// slipped_targets, fit_ms. What could not be measured is null.
std::string gazeReportJson(const GazeReport& report);

/// A few lines and a table by target.
std::string gazeReportText(const GazeReport& report);

/// A page of its own, with the targets drawn.
std::string gazeReportHtml(const GazeReport& report);

}  // namespace foci
