// Calibration samples grouped by target. Private to the fit.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/map_units.h"

namespace foci {

/// All samples of one target: the fit sees each target as one robust point.
struct Station {
  glm::dvec2 target{0.0};
  glm::dvec2 gaze{0.0};     ///< robust centre of the samples
  glm::dvec2 gaze_sd{0.0};  ///< robust deviation of the samples per axis
  glm::dvec2 deg_per_unit{1.0};
  double weight = 1.0;  ///< 0.1 to 1
  std::vector<glm::dvec2> samples;
};

/// Throws InputError: the gaze calibration is refused because of `why`.
[[noreturn]] void refuseGazeCalibration(const std::string& why);

/// One station for each target at which gaze was measured, ordered by target.
/// @throws InputError where no sample has gaze, or targets are more than 10000
std::vector<Station> stationsOf(std::span<const GazePair> pairs, const GazeFrame& frame);

/// Removes targets whose samples lie as far apart as the targets do: the observer looked
/// elsewhere. Of targets with the same gaze it keeps at most the one that an affine map through the
/// others confirms: one gaze cannot mean two targets. Keeps all if fewer than three would remain,
/// or fewer than half.
/// @return the removed targets
std::vector<glm::dvec2> dropBadTargets(std::vector<Station>& stations);

/// @throws InputError where targets are fewer than 3 or collinear, where gaze does not move in two
///   directions, or where targets contradict each other (which `dropBadTargets` leaves only if they
///   are too many)
void refuseUnusable(std::span<const Station> stations);

/// Smaller and larger standard deviation of a cloud of points along its principal axes.
glm::dvec2 extents(std::span<const Station> stations, glm::dvec2 Station::*point);

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
