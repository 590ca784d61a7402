// The stability suite: every scene at every value of its dial, scored for every method. An
// interrupted run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/stability/plan.h"
#include "app/platform/output_guard.h"

namespace foci {

/// A row of stability.csv.
struct StabilityPoint {
  std::string scene;
  float value = 0.0f;  ///< of the dial
  std::string by;      ///< a method's spec, or an observer
  double score = 0.0;
};

struct StabilityResult {
  std::vector<StabilityPoint> points;  ///< by scene, value, method
  std::size_t computed = 0, kept = 0;  ///< cells that this run measured, and found complete
};

/// The methods of the plan, or the scene's own observers.
std::vector<std::string> scoredIn(const StabilityPlan& plan, const StabilityScene& scene);

/// Image files relative to the chart's folder. Scenes of gaze have none.
std::string stabilityImage(const std::string& scene, float value, const EvaluatedMethod& method);
std::string stabilityReference(const std::string& scene, float value);

/// A dial's value as text.
std::string dialText(float value);

/// The files that `measureStability` writes.
std::vector<std::filesystem::path> measuredFiles(const StabilityPlan& plan,
                                                 const std::filesystem::path& folder);

/// Number of steps that `measureStability` reports.
std::size_t stepsOf(const StabilityPlan& plan);

/// @param folder    of the chart: cells go to `cells`, images to `images`
/// @param on_steps  called with the number of steps done since the last call
StabilityResult measureStability(const StabilityPlan& plan, const std::filesystem::path& folder,
                                 const OutputGuard& guard,
                                 const std::function<void(std::size_t)>& on_steps);

/// stability.csv.
std::string csvOf(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

}  // namespace foci
