// Time and error of every method of a plan. An interrupted run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "app/evaluation/cells.h"
#include "app/evaluation/chart/plan.h"
#include "app/evaluation/chart/points.h"

namespace foci {

/// The files that `measureChart` writes.
std::vector<std::filesystem::path> measuredFiles(const ChartPlan& plan,
                                                 const std::filesystem::path& folder);

/// Number of steps that `measureChart` reports.
std::size_t stepsOf(const ChartPlan& plan);

/// Compares the first frame of each method with the reference. Then times the methods, which take
/// turns, so that other load on the machine slows all of them alike. Consecutive timed frames
/// differ in aperture by a thousandth, so that no method can reuse its previous frame. A method
/// that takes four times `plan.timing_ms` is timed by its first frame.
/// @return by scene, blur, method, threads
Measured<ChartPoint> measureChart(const ChartPlan& plan, const ChartCells& cells,
                                  const OnSteps& on_steps);

}  // namespace foci
