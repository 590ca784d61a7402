// The plan of `foci chart`: scenes, blurs, methods with their settings, and how long to measure.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_choice.h"
#include "app/evaluation/scene_in_view.h"

namespace foci {

/// What a scene's methods are held against.
enum class ChartTruth {
  surfels,    ///< many sharp views of the same surfels: `accumulate:N`
  triangles,  ///< the mesh that the surfels were sampled from: `raytrace:N`
};

struct ChartScene {
  std::string id;          ///< in file names and in chart.csv
  std::string title;       ///< for people
  std::string input = {};  ///< `scanKey` of a scan; empty for a built-in scene
  std::function<SceneInView()> make;
  ChartTruth truth = ChartTruth::surfels;
  bool gaussians = false;                     ///< a scene of Gaussians, which fewer methods render
  std::vector<EvaluatedMethod> methods = {};  ///< those of the plan that render the scene
};

struct ChartPlan {
  bool quick = false;
  int size_px = 0;  ///< width of the images
  std::vector<ChartScene> scenes = {};
  std::vector<double> blurs_px = {};   ///< largest blur radius in view, rising
  std::vector<unsigned> threads = {};  ///< rising; the last entry is all threads
  int min_views = 0, max_views = 0;    ///< of the references
  int rays = 0;                        ///< a pixel, of the references that are traced
  double timing_ms = 0.0;  ///< about how long to time one method at one number of threads
  int max_runs = 0;        ///< of one method at one number of threads

  /// Views of the reference: one for each pixel of the largest disc, pi C^2 (formulas.md, 7),
  /// clamped to `min_views` and `max_views`.
  int views(double blur_px) const;

  /// The method that makes a scene's reference. Without ray tracing (FOCI_RAYTRACE), every scene
  /// has `accumulate`.
  std::string reference(const ChartScene& scene, double blur_px) const;

  /// All that the frames of a scene at one blur depend on, besides their methods.
  std::string key(const ChartScene& scene, double blur_px) const;
};

/// The scenes that the user chose, each with the methods that render it.
/// @param spacing  of the surfels of the plane and the gallery, relative to a chart's
/// @throws InputError for an unknown scene or method, or a scan that cannot be read
std::vector<ChartScene> chosenScenes(const EvaluationChoice& choice, int size_px,
                                     SettingRange range, float spacing = 1.0f);

/// @throws InputError as `chosenScenes`
ChartPlan planChart(const EvaluationChoice& choice);

}  // namespace foci
