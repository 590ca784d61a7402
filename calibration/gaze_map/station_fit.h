// The linear model under a gaze map: one row for each target ("station"), both axes with the same
// terms. A target that the observer did not look at gets no weight. Private: Eigen is heavy.
#pragma once

#include <Eigen/Dense>

#include "calibration/gaze_map/gaze_map.h"

namespace foci {

/// Deviation per axis, chosen by hand: no observer fixates more precisely. With exact data it keeps
/// tiny misfits from counting as outliers.
inline constexpr double kNoiseFloor_deg = 0.06;

/// One model's linear system: design * coefficients = goal.
struct StationSystem {
  GazeModel model = GazeModel::offset;
  double shrinkage = 0.0;
  Eigen::MatrixXd design{};  // stations x terms
  Eigen::MatrixXd goal{};    // stations x 2, units
  Eigen::MatrixXd metric{};  // stations x 2, degrees per unit
  Eigen::VectorXd weight{};  // one for each station

  /// Prior precision of a term, over the noise's: only powers above the affine are shrunk.
  double prior(Eigen::Index term) const { return term > 2 ? shrinkage : 0.0; }
};

struct StationSolution {
  Eigen::MatrixXd coefficients;  // terms x 2, units
  Eigen::MatrixXd covariance;    // terms x terms, deg^2
  Eigen::VectorXd weight;        // that the loss left each station, 0 to 1
  Eigen::VectorXd leverage;      // diagonal of the hat matrix
  Eigen::MatrixXd residual;      // stations x 2, deg
  double sd_deg = 0.0;           // per axis
  double freedom = 0.0;          // stations less effective terms
  Eigen::MatrixXd inverse;       // of the normal matrix
};

/// Minimises Tukey's loss over the stations. The start leaves out slipped targets: up to three
/// together whose removal lowers the residual by more than chance would.
/// @throws InputError where Ceres finds no usable solution
StationSolution fitStations(const StationSystem& system);

}  // namespace foci
