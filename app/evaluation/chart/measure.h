// Time and error of every method of a plan. An interrupted run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "app/evaluation/chart/plan.h"
#include "app/evaluation/chart/points.h"
#include "app/platform/output_guard.h"

namespace foci {

struct ChartResult {
  std::vector<ChartPoint> points;          ///< by scene, blur, method, threads
  std::size_t computed = 0, kept = 0;      ///< cells that this run measured, and found complete
  std::vector<std::string> warnings = {};  ///< of the scan
};

/// The files that `measureChart` writes.
std::vector<std::filesystem::path> measuredFiles(const ChartPlan& plan,
                                                 const std::filesystem::path& folder);

/// Number of steps that `measureChart` reports.
std::size_t stepsOf(const ChartPlan& plan);

/// Compares the first frame of each method with the reference. Then times the methods, which take
/// turns, so that other load on the machine slows all of them alike. Consecutive timed frames
/// differ in aperture by a thousandth, so that no method can reuse its previous frame. A method
/// that takes four times `plan.timing_ms` is timed by its first frame.
/// @param folder    of the chart: cells go to `cells`, images to `images`
/// @param on_steps  called with the number of steps done since the last call
ChartResult measureChart(const ChartPlan& plan, const std::filesystem::path& folder,
                         const OutputGuard& guard,
                         const std::function<void(std::size_t)>& on_steps);

}  // namespace foci
