// Every scene of the stability suite at every value of its dial, scored for every method, going on
// where an earlier run stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"

namespace foci {

/// A row of stability.csv.
struct StabilityPoint {
  std::string scene;
  float value = 0.0f;
  std::string by;  ///< a method's spec, or an observer
  double score = 0.0;
};

struct StabilityResult {
  std::vector<StabilityPoint> points;  ///< by scene, value, method
  std::size_t computed = 0, kept = 0;  ///< cells that this run worked on, and found done
};

/// Who is scored in a scene: the plan's methods, or the scene's own observers.
std::vector<std::string> scoredIn(const StabilityPlan& plan, const StabilityScene& scene);

/// Where the images of a cell are, relative to the chart's folder. Of observers there are none.
std::string stabilityImage(const std::string& scene, float value, const ChartMethod& method);
std::string stabilityReference(const std::string& scene, float value);

/// A dial's value as it is written.
std::string dialText(float value);

/// Steps that `measureStability` reports.
std::size_t stepsOf(const StabilityPlan& plan);

/// @param folder   of the chart: cells go to `cells`, images to `images`
/// @param on_steps called after so many steps
StabilityResult measureStability(const StabilityPlan& plan, const std::filesystem::path& folder,
                                 const std::function<void(std::size_t)>& on_steps);

/// stability.csv.
std::string csvOf(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

}  // namespace foci
