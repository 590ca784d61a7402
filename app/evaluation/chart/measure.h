// Time and error of every method in a plan, cell by cell, going on where an earlier run stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"

namespace foci {

/// A row of chart.csv.
struct ChartPoint {
  std::string scene;
  double blur_px = 0.0;
  ChartMethod method = {};
  unsigned threads = 0;
  double ms_median = 0.0, ms_min = 0.0;
  double psnr_dB = 0.0;  ///< infinite where it is the reference to the bit
  double ssim = 0.0;
  std::optional<double> silhouette_psnr_dB = {};
  double coverage_error = 0.0;
  double visible_error = 0.0;                 ///< see `ChartCell`
  std::optional<double> expected_error = {};  ///< likewise
  double reference_psnr_dB = 0.0;  ///< the reference's own, one half of its views against the other
  bool on_frontier = false;        ///< see `markFrontiers`
};

struct ChartResult {
  std::vector<ChartPoint> points;      ///< by scene, blur, method, threads
  std::size_t computed = 0, kept = 0;  ///< cells that this run worked on, and found done
};

/// Where the images of a cell are, relative to the chart's folder.
std::string imageFile(const std::string& scene, double blur_px, const ChartMethod& method);
std::string differenceFile(const std::string& scene, double blur_px, const ChartMethod& method);
std::string referenceFile(const std::string& scene, double blur_px);

/// Steps that `measureChart` reports.
std::size_t stepsOf(const ChartPlan& plan);

/// Each method's first frame is held against the reference; then all take turns, so that whatever
/// else the machine does meets all alike. Every timed frame has an aperture a thousandth off the
/// one before: no method can keep its last frame. What takes fifteen times as
/// long as `plan.timing_ms` is timed by that first frame.
/// @param folder   of the chart: cells go to `cells`, images to `images`
/// @param on_steps called after so many steps
ChartResult measureChart(const ChartPlan& plan, const std::filesystem::path& folder,
                         const std::function<void(std::size_t)>& on_steps);

/// PSNR as far as it means something: no more than the reference's own.
double worthOf_dB(const ChartPoint& point);

/// Fills in `on_frontier`: of time and `worthOf_dB`, among those of a scene, blur and number of
/// threads.
void markFrontiers(std::vector<ChartPoint>& points);

/// chart.csv.
std::string csvOf(const std::vector<ChartPoint>& points);

}  // namespace foci
