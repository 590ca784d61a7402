// Motion, the third axis of the chart: what each method adds to the change from frame to frame. An
// interrupted run continues where it stopped.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/evaluation/cells.h"
#include "app/evaluation/chart/chart.h"
#include "app/evaluation/scene_in_view.h"
#include "render/optics/view.h"

namespace foci {

/// The eye at a frame.
struct MotionStep {
  std::vector<View> views;  ///< of one eye, or of the left and the right one
  double focus_D = 0.0;
  double rest_D = 0.0;                  ///< where the focus is on its way to
  double pupil_mm = 0.0;                ///< at most `kMaxPupil_mm`
  std::optional<glm::dvec2> gaze_px{};  ///< with foveation
  bool in_saccade = false;
};

/// Through a pupil of this diameter, a scene has the chart's blur.
inline constexpr double kMaxPupil_mm = 6.0;

inline constexpr int kMotionFrames = 48;  ///< of a path, 60 a second

inline constexpr std::array<std::string_view, 7> kMotionPaths{
    "head-1mm", "head-10mm", "stereo", "head-forwards", "focus", "pupil", "saccade"};

/// The steps of a path. A head sways to and fro, so many a frame; equal places have equal views.
/// The focus moves as accommodation does (accommodation.h), to the decile of the vergences in view
/// that lies farther from the scene's focus; the pupil is then so narrow that no blur exceeds the
/// chart's.
std::vector<MotionStep> motionSteps(std::string_view path, const SceneInView& scene);

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
/// @return by scene, path, method
Measured<MotionPoint> measureMotion(const MotionPlan& plan, const ChartCells& cells,
                                    const OnSteps& on_steps);

/// motion.csv.
std::string csvOf(const std::vector<MotionPoint>& points);

/// A complete HTML page: each scene and path is a panel, and every method a point. Its links are
/// relative to the chart's folder.
std::string motionPage(const MotionPlan& plan, const Measured<MotionPoint>& measured);

}  // namespace foci
