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

/// How closely kernels sum to one over the surface, seen at some size of the pixels.
struct Normalisation {
  double pixel_spacings = 1.0;           ///< side of a pixel over the spacing of the surfels
  double within_2, within_5, within_10;  ///< shares within 1 +- 0.02, 0.05, 0.1
  double smooth_within_2, smooth_within_5, smooth_within_10;  ///< of the smooth parts
  double mean;
  std::vector<std::size_t>
      histogram;  ///< of the sums: kHistogramBins from 0.5 to 1.5, ends included
};
inline constexpr std::size_t kHistogramBins = 100;

struct PrepareSummary {
  std::filesystem::path out, report;
  std::size_t surfels = 0;
  std::size_t dropped = 0;  ///< points left out since their position was not finite
  bool oriented = false;
  double area_m2 = 0.0;
  double spacing_m = 0.0;     ///< median of sqrt(area)
  double smooth_share = 0.0;  ///< of the surface
  double seconds = 0.0;
  std::vector<Normalisation> normalisation = {};  ///< by falling size of the pixels
};

/// Nothing is left where it fails. Progress goes to standard error.
/// @throws InputError, std::runtime_error
PrepareSummary prepareScene(const PrepareRequest& request);

/// Adds `prepare` to the command line; it runs as the arguments are parsed.
void addPrepareCommand(CLI::App& app);

}  // namespace foci
