// The linear model under a gaze map: one row a target ("station"), both axes with the same terms,
// fitted so that a target which nobody looked at has no say.
#pragma once

#include <Eigen/Dense>

#include "calibration/gaze_map/gaze_map.h"

namespace foci {

/// Per axis: nobody looks at a target more exactly, and exact data must not make every misfit an
/// outlier.
inline constexpr double kNoiseFloor_deg = 0.06;

/// One model's linear system: design * coefficients = goal, in degrees along each axis.
struct StationSystem {
  GazeModel model = GazeModel::offset;
  double shrinkage = 0.0;
  Eigen::MatrixXd design{};  // stations x terms
  Eigen::MatrixXd goal{};    // stations x 2, units
  Eigen::MatrixXd metric{};  // stations x 2, degrees per unit
  Eigen::VectorXd weight{};

  double prior(Eigen::Index term) const { return term > 2 ? shrinkage : 0.0; }
};

struct StationSolution {
  Eigen::MatrixXd coefficients;  // terms x 2, units
  Eigen::MatrixXd covariance;    // terms x terms, deg^2
  Eigen::VectorXd weight;        // the loss's, 0 to 1
  Eigen::VectorXd leverage;
  Eigen::MatrixXd residual;  // stations x 2, deg
  double sd_deg = 0.0;       // per axis
  double freedom = 0.0;      // stations less effective terms
  Eigen::MatrixXd inverse;   // of the normal matrix
};

/// Tukey's loss on whole stations, minimised by Ceres from the start that is left when the slipped
/// targets are taken out: those, up to three at once, whose removal lowers the residual by more
/// than chance.
StationSolution fitStations(const StationSystem& system);

}  // namespace foci
