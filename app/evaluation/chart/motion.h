// Motion, the third axis of the chart: what each method adds to the change from frame to frame. An
// interrupted run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/chart/motion_path.h"
#include "app/evaluation/chart/plan.h"
#include "app/platform/output_guard.h"

namespace foci {

struct MotionPlan {
  bool quick = false;
  int size_px = 0;       ///< width of the images
  double blur_px = 6.0;  ///< largest blur radius in view
  int views = 0;         ///< of the references
  int frames = 0;        ///< that foci's own methods render of each path
  int other_frames = 0;  ///< that the other methods render
  std::vector<ChartScene> scenes = {};
};

/// Scenes as in a chart. The surfels of plane, gallery and mask are as far apart in pixels as
/// there.
/// @throws InputError for an unknown scene or method, or a scan that cannot be read
MotionPlan planMotion(const EvaluationChoice& choice);

/// A row of motion.csv: a method on a path. `ExcessChange` explains light and JND.
struct MotionPoint {
  std::string scene, path;
  EvaluatedMethod method;
  std::optional<double> budget_ms;  ///< the frame-time budget of `auto`
  double light_worst = 0.0, light_median = 0.0, jnd_worst = 0.0, jnd_median = 0.0;
  int worst_frame = 0;     ///< the first of the pair with the largest excess in light
  double ms_median = 0.0;  ///< of the frames that were rendered

  /// "auto", or "auto, 12 ms".
  std::string by() const;
  /// The file with the worst frame, the next one and the excess change; relative to the folder.
  std::string strip() const;
};

std::vector<std::filesystem::path> measuredFiles(const MotionPlan& plan,
                                                 const std::filesystem::path& folder);
std::size_t stepsOf(const MotionPlan& plan);

/// Each method renders the frames of a path one after another, as a session does: it keeps its
/// state, and `auto` reuses frames that change too little to see. `auto` runs a second time within
/// half of the time that it took. Frames within a saccade do not count, nor does the landing.
/// @param folder    of the chart: cells go to `cells`, strips to `images`
/// @return by scene, path, method
Measured<MotionPoint> measureMotion(const MotionPlan& plan, const std::filesystem::path& folder,
                                    const OutputGuard& guard, const OnSteps& on_steps);

/// motion.csv.
std::string csvOf(const std::vector<MotionPoint>& points);

/// A complete HTML page: each scene and path is a panel, and every method a point. Its links are
/// relative to the chart's folder.
std::string motionPage(const MotionPlan& plan, const Measured<MotionPoint>& measured);

}  // namespace foci
