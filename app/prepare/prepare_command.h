// foci prepare: points or a mesh to a scene file whose kernels sum to one, with a report of how
// closely.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace foci {

struct PrepareRequest {
  std::filesystem::path input;   ///< PLY points, or a mesh
  std::filesystem::path out;     ///< the scene, .foci; the report stands beside it, .html
  double scale_m = 1.0;          ///< metres a unit of the input
  std::size_t points = 500'000;  ///< about, where the input is a mesh
};

/// How closely kernels sum to one over the surface, seen at some size of the pixels or the blur.
struct Normalisation {
  double pixel_spacings, blur_spacings;  ///< see `SeenAs`
  double smooth_share;                   ///< of the surface; 0: what is said of it means nothing
  double within_2, within_5, within_10;  ///< shares within 1 +- 0.02, 0.05, 0.1
  double smooth_within_2, smooth_within_5, smooth_within_10;  ///< of the smooth parts
  double mean, smooth_mean;
  /// Of the sums, of all and of those of smooth parts: kHistogramBins from 0.5 to 1.5, ends
  /// included.
  std::vector<std::size_t> histogram, smooth_histogram;
};
inline constexpr std::size_t kHistogramBins = 100;

/// A level of detail where it is rendered at its coarsest: in focus, and blurred.
struct LevelNormalisation {
  std::size_t nodes;
  Normalisation sharp, blurred;
};

struct PrepareSummary {
  std::filesystem::path out, report;
  std::size_t surfels = 0;
  std::size_t dropped = 0;  ///< points left out since their position was not finite
  bool oriented = false;
  double area_m2 = 0.0;
  double spacing_m = 0.0;  ///< median of sqrt(area)
  double seconds = 0.0;
  /// Of the surfels, by falling size of the pixels, and of the same with areas not yet solved.
  std::vector<Normalisation> normalisation = {}, before = {};
  std::vector<LevelNormalisation> levels = {};  ///< from fine to coarse, of enough nodes to tell
};

/// Nothing is left where it fails. Progress goes to standard error.
/// @throws InputError, std::runtime_error
PrepareSummary prepareScene(const PrepareRequest& request);

/// Adds `prepare` to the command line; it runs as the arguments are parsed.
void addPrepareCommand(CLI::App& app);

}  // namespace foci
