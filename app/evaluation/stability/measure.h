// The stability suite: every scene at every value of its dial, scored for every method. An
// interrupted run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/evaluation/cells.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/stability/scenes.h"
#include "app/graphics/drawing.h"

namespace foci {

/// How much work a trial does.
struct StabilityEffort {
  int samples = 64;  ///< of the lens, for the reference
  int steps = 4;     ///< frames after the first one, if something moves
};

/// A trial renders its reference when it first needs it.
class StabilityTrial {
 public:
  /// @param scene  scored by images (asserted)
  StabilityTrial(const StabilityScene& scene, float value, const StabilityEffort& effort);

  /// @param method  as `makeMethod` takes it
  double score(std::string_view method);

  /// The last frame that was scored. If something moves, it is the last step.
  const Frame& rendered() const { return rendered_; }
  /// The reference of that frame.
  const Frame& reference();

  const StabilitySetup& setup() const { return setup_; }

 private:
  Frame render(std::string_view method, const SurfelCloud& cloud) const;
  double popping(std::string_view method);
  const std::vector<Frame>& references();

  StabilitySetup setup_;
  StabilityEffort effort_;
  Frame rendered_;
  std::vector<Frame> references_;  // one frame, or the first frame and one for each step
};

struct StabilityPlan {
  bool quick = false;
  StabilityEffort effort = {};
  std::vector<StabilityScene> scenes = {};  ///< with the values to measure
  std::vector<EvaluatedMethod> methods = {};
};

/// A plan of every method with one setting, unless the user chose others. `choice.size_px` has no
/// effect: the scenes have sizes of their own.
/// @throws InputError for an unknown scene or method, or a scan that cannot be read
StabilityPlan planStability(const EvaluationChoice& choice);

/// A row of stability.csv.
struct StabilityPoint {
  std::string scene;
  float value = 0.0f;  ///< of the dial
  std::string by;      ///< a method's spec, or an observer
  double score = 0.0;
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

/// @return by scene, value, method
Measured<StabilityPoint> measureStability(const StabilityPlan& plan, const ChartCells& cells,
                                          const OnSteps& on_steps);

/// stability.csv.
std::string csvOf(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

// The page.

/// A complete HTML page. Its links are relative to the chart's folder.
/// @param notice  of what the page misses; empty: nothing
std::string stabilityPage(const StabilityPlan& plan, const std::vector<StabilityPoint>& points,
                          const std::string& notice);

/// All panels in one image: for pages without links.
Drawing stabilityOverview(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

}  // namespace foci
