// The plan of `foci chart`, its points, its panels and its page. First the plan: scenes, blurs,
// methods with their settings, and how long to measure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/cells.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/scene_in_view.h"
#include "app/graphics/plot.h"
#include "render/image/frame.h"
#include "render/methods/quality_level.h"
#include "render/optics/defocus.h"

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

// The points of the chart: one method at one blur and one number of threads; frontiers; chart.csv.

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

// Time against accuracy: one scene at one blur and number of threads; every method is a point. The
// page of all panels.

/// The accuracy that a panel shows.
enum class ChartMeasure {
  psnr,        ///< over the image
  silhouette,  ///< over the pixels that a step in depth blurs into
};

/// The frontier is that of the measure shown.
/// @param points  of one scene, blur and number of threads; at least one has the measure
Plot panelOf(const std::vector<ChartPoint>& points, ChartMeasure measure, const std::string& title);

/// All scenes at one blur in one image, with the machine's name: for pages without links.
Drawing overviewOf(const ChartPlan& plan, const std::vector<ChartPoint>& points, double blur_px);

/// A complete HTML page: which method to use when, the panels, and every image as a link. Its links
/// are relative to the chart's folder.
std::string chartPage(const ChartPlan& plan, const Measured<ChartPoint>& measured);

}  // namespace foci
