// Turns points, a mesh or Gaussians into a scene file. Gaussians get their levels of detail. Sizes
// and weights of the splats are solved so that their kernels form a partition of unity; a report
// states how closely they do.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/prepare/fidelity.h"
#include "render/scene/io/scene_facts.h"

namespace foci {

struct PrepareRequest {
  std::filesystem::path input;  ///< points, a mesh or Gaussians
  std::filesystem::path out;    ///< the scene, .foci; the report gets the same name with .html
  double scale_m = 1.0;         ///< length of a unit of the input, metres
  std::optional<std::size_t> points = {};  ///< about the number of samples of a mesh
  /// The axis upwards, 0 to 2, for whoever shows the scene.
  std::function<std::optional<int>(const SceneFacts&)> up_axis = {};
  bool overwrite = false;  ///< replace files that foci did not make, too
};

/// Sums of the kernels at points of a surface.
struct KernelSumFigures {
  double mean = 0.0;
  double within_2, within_5, within_10;  ///< shares of the points within 1 +- 0.02, 0.05, 0.1
  /// `kHistogramBins` bins from 0.5 to 1.5. The end bins also count the sums beyond.
  std::vector<std::size_t> histogram;
};

/// How closely kernels form a partition of unity over the surface, at one size of pixels or blur.
struct Normalisation {
  double pixel_spacings, blur_spacings;  ///< see `SeenAs`
  double smooth_share;  ///< share of the surface that is smooth; 0: `smooth` has no meaning
  KernelSumFigures whole, smooth;
};
inline constexpr std::size_t kHistogramBins = 100;

/// A level of detail, seen where foci renders it at its coarsest: in focus, and blurred.
struct LevelNormalisation {
  std::size_t nodes;
  Normalisation sharp, blurred;
};

struct PrepareSummary {
  std::filesystem::path out, report;
  SceneFacts facts{};  ///< of the input
  std::size_t surfels = 0;
  std::size_t gaussians = 0, nodes = 0;  ///< of a scene of Gaussians: nothing below describes it
  std::size_t dropped = 0;  ///< points or Gaussians left out because a value is not finite
  bool oriented = false;
  double area_m2 = 0.0;
  double spacing_m = 0.0;  ///< median of sqrt(area)
  double seconds = 0.0;
  /// After and before the solve, by falling size of the pixels.
  std::vector<Normalisation> normalisation = {}, before = {};
  std::vector<LevelNormalisation> levels =
      {};                ///< from fine to coarse, of levels with enough nodes
  bool of_mesh = false;  ///< the input has triangles
  /// Absent for points, and without ray tracing.
  std::optional<FidelityReport> fidelity = {};
  std::vector<std::string> warnings = {};  ///< one sentence each, with the option to set
};

/// If it throws, it leaves nothing behind. Progress goes to standard error.
/// @throws InputError, std::runtime_error
PrepareSummary prepareScene(const PrepareRequest& request);

/// CSS of the section, besides `kPageStyle`.
extern const char* const kFidelityStyle;

/// Figures, a map of all views and the worst view, as HTML; or why there are none.
std::string fidelitySection(const PrepareSummary& summary);

/// The figures in one sentence, for a terminal; or why there are none.
std::string fidelityText(const PrepareSummary& summary);

}  // namespace foci
