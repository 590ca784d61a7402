// The points of the chart: one method at one blur and one number of threads; frontiers; chart.csv.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/cells.h"
#include "app/evaluation/chart/plan.h"
#include "app/evaluation/evaluated_methods.h"
#include "render/image/frame.h"
#include "render/methods/quality_level.h"
#include "render/optics/defocus.h"

namespace foci {

/// A row of chart.csv.
struct ChartPoint : ChartErrors {
  std::string scene = {};
  double blur_px = 0.0;  ///< largest blur radius in view
  EvaluatedMethod method = {};
  /// Version and machine of another renderer, whose name the method has; empty: a method of foci's.
  std::string renderer = {};
  unsigned threads = 0;
  double ms_median = 0.0, ms_min = 0.0;
  double reference_psnr_dB = 0.0;  ///< of the reference: one half of its views against the other
  bool on_frontier = false;        ///< see `markFrontiers`
};

/// PSNR as far as the reference can tell: at most the reference's own.
double worthOf_dB(const ChartPoint& point);

/// Sets `on_frontier`: the frontier of time and `worthOf_dB` among the points of one scene, blur
/// and number of threads.
void markFrontiers(std::vector<ChartPoint>& points);

/// Whether other renderers are among the points.
bool hasImported(const std::vector<ChartPoint>& points);

/// The points of one scene, blur and number of threads.
std::vector<ChartPoint> pointsOf(const std::vector<ChartPoint>& points, const std::string& scene,
                                 double blur_px, unsigned threads);

/// chart.csv.
std::string csvOf(const std::vector<ChartPoint>& points);

/// Image files relative to the chart's folder.
std::string imageFile(const std::string& scene, double blur_px, const EvaluatedMethod& method);
/// An imported image is named apart from those of foci's methods.
std::string imageFile(const ChartPoint& point);
std::string referenceFile(const std::string& scene, double blur_px);

/// The Pareto frontier of (cost, worth). Entry i lies on the frontier if no other entry costs at
/// most as much and is worth at least as much, one of the two strictly. Equal entries lie on the
/// frontier together. Infinities are ordinary values. NaN and lists of different lengths are not
/// allowed (asserted).
std::vector<bool> paretoFrontier(const std::vector<double>& cost, const std::vector<double>& worth);

/// What frames are compared with.
struct Compared {
  const Frame* reference = nullptr;
  std::vector<glm::vec3> lab{};      ///< `labOf` the reference
  std::vector<std::uint8_t> band{};  ///< the silhouettes
};

/// @param reference  must outlive the result
/// @param pinhole    a frame without blur, with depth
Compared comparedWith(const Frame& reference, const Frame& pinhole, const Defocus& lens);

/// Without what `auto` states.
ChartErrors scoresOf(const Frame& frame, const Compared& with);

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
