// The one door to Ceres' solver. Private: Ceres is heavy to compile.
#pragma once

#include <ceres/ceres.h>

#include <string>

namespace foci {

/// Minimises `problem` from the current values of its parameters, on one thread and without output:
/// the same input gives the same bytes on every machine.
/// @param where  the calibration, as messages name it
/// @throws InputError unless Ceres calls the solution usable (`Summary::IsSolutionUsable`)
void solve(ceres::Solver::Options options, ceres::Problem& problem, const std::string& where);

}  // namespace foci
