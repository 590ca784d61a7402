// The one door to Ceres' solver. Private: Ceres is heavy to compile.
#pragma once

#include <ceres/ceres.h>

#include <string>
#include <vector>

namespace foci {

/// Minimises `problem` from the current values of its parameters, on one thread and without output:
/// the same input gives the same bytes on every machine.
/// @param where  the calibration, as messages name it
/// @throws InputError unless Ceres calls the solution usable (`Summary::IsSolutionUsable`)
void solve(ceres::Solver::Options options, ceres::Problem& problem, const std::string& where);

/// Variances of a solution's block of parameters, 0 for fixed ones. One that is not determined has
/// a large variance. Empty where nothing is determined.
std::vector<double> variancesOf(ceres::Problem& problem, const double* block);

}  // namespace foci
