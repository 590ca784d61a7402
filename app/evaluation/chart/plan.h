// What `foci chart` measures: which scenes, how much blur, which methods with which settings, how
// long; with --stability, which dials.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "app/evaluation/stability/scenes.h"

namespace foci {

struct ChartScene {
  std::string id;     ///< in names of files and in chart.csv
  std::string title;  ///< for people
  std::string input;  ///< as of `inputOf`; empty for what is built in
  std::function<SceneInView()> make;
};

/// SHA-256 of a scan and its pose: what figures of it hang on.
std::string inputOf(const ScanView& scan);

/// A method with its number, if it takes one.
struct ChartMethod {
  std::string name;
  std::optional<int> setting;

  std::string spec() const { return name + (setting ? ":" + std::to_string(*setting) : ""); }
  std::string fileName() const { return name + (setting ? "-" + std::to_string(*setting) : ""); }
};

struct ChartPlan {
  bool quick = false;
  int size_px = 0;  ///< width of the images
  std::vector<ChartScene> scenes = {};
  std::vector<double> blurs_px =
      {};  ///< rising: of the largest circle of confusion in view, radius
  std::vector<ChartMethod> methods = {};
  std::vector<unsigned> threads = {};  ///< rising, the last being all
  int min_views = 0, max_views = 0;    ///< of the references
  double timing_ms = 0.0;  ///< for the runs of one method at one number of threads, about
  int max_runs = 0;

  /// Views of the reference: one a pixel of the largest disc, pi C^2 (formulas.md, 7), in bounds.
  int views(double blur_px) const;
};

struct ChartChoice {
  bool quick = false;
  std::optional<ScanView> scan = {};  ///< in place of the statue
  std::optional<int> size_px = {};
  std::vector<std::string> scenes = {};   ///< only these, by id; empty: all
  std::vector<std::string> methods = {};  ///< only these, `name` or `name:N`; empty: all
};

/// Every method there is, each with settings that span what it can do.
/// @throws InputError for an unknown scene or method, or a scan that cannot be read
ChartPlan planChart(const ChartChoice& choice);

/// What `foci chart --stability` measures.
struct StabilityPlan {
  bool quick = false;
  StabilityEffort effort = {};
  std::vector<StabilityScene> scenes = {};  ///< with the values that are measured
  std::vector<ChartMethod> methods = {};
};

/// Every method, with one setting each. @param choice  its size does not matter
/// @throws InputError as `planChart`
StabilityPlan planStability(const ChartChoice& choice);

}  // namespace foci
