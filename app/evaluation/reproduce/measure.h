// What each method makes of a scene at each aperture, and what it costs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/scenes.h"
#include "render/image/frame.h"

namespace foci {

/// The method that is ours, and that draws the figures.
inline constexpr const char* kOurs = "sweep-lod";

/// How much is done. Times are of runs taken in turn, after one that is not counted.
struct ReproduceEffort {
  int runs = 15;
  int accumulate_runs = 3;  ///< of `accumulate:200`, which draws 200 views a run
  int min_views = 256;      ///< of the reference
  int max_views = 4096;
  int figure1_views = 400;  ///< of the references of Figure 1
};

/// A row of table1.csv.
struct ReproduceRow {
  std::string scene;
  std::size_t aperture = 0;  ///< 0, 1, 2
  double aperture_m = 0.0;
  double blur_px_max = 0.0;
  std::string method;
  bool lod = false;
  double kfragments = 0.0;
  std::uint64_t points = 0;
  double ms_median = 0.0, ms_min = 0.0;
  unsigned threads = 0;
  double psnr_dB = 0.0;  ///< infinite where it is the reference to the bit
  double ssim = 0.0;
  std::optional<double> silhouette_psnr_dB;  ///< nothing where no silhouette is in view
};

/// What the accuracy is measured against: `accumulate:views`; without blur one view.
struct ReproduceReference {
  int views = 1;
  std::optional<double> split_half_psnr_dB;  ///< of more than one view
  Frame frame;
};

struct SceneResult {
  std::vector<ReproduceRow> rows;
  std::array<ReproduceReference, kApertures> reference;
  /// By method, at each aperture; `accumulate` is not kept.
  std::map<std::string, std::array<Frame, kApertures>> frames;
};

/// Views of the reference: one a pixel of the largest disc, pi C^2 (formulas.md, 7), within bounds.
int referenceViews(const ReproduceScene& scene, std::size_t aperture,
                   const ReproduceEffort& effort);

/// Frames that `measureScene` draws, each of N views counted.
std::size_t framesToMeasure(const ReproduceScene& scene, const ReproduceEffort& effort,
                            const std::vector<unsigned>& threads);

/// @param threads   numbers of threads to measure at, rising, the last being all
/// @param on_frames called after so many frames
SceneResult measureScene(const ReproduceScene& scene, const ReproduceEffort& effort,
                         const std::vector<unsigned>& threads,
                         const std::function<void(std::size_t)>& on_frames);

/// table1.csv.
std::string csvOf(const std::vector<ReproduceRow>& rows);

}  // namespace foci
