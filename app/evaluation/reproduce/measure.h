// Accuracy and time of each method on a scene at each aperture.
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

/// foci's own method, which renders the figures.
inline constexpr const char* kOurs = "sweep-lod";

/// How much work a measurement does. The timed runs take turns, after one that does not count.
struct ReproduceEffort {
  int runs = 15;
  int accumulate_runs = 3;  ///< of `accumulate:200`, which renders 200 views in each run
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
  double psnr_dB = 0.0;  ///< infinite if every bit equals the reference's
  double ssim = 0.0;
  std::optional<double> silhouette_psnr_dB;  ///< absent without a silhouette in view
};

/// The frame that methods are compared with: `accumulate:views`; without blur a single view.
struct ReproduceReference {
  int views = 1;
  std::optional<double> split_half_psnr_dB;  ///< absent for a single view
  Frame frame;
};

struct SceneResult {
  std::vector<ReproduceRow> rows;
  std::array<ReproduceReference, kApertures> reference;
  /// By method and aperture, without those of `accumulate`.
  std::map<std::string, std::array<Frame, kApertures>> frames;
};

/// Views of the reference: one for each pixel of the largest disc, pi C^2 (formulas.md, 7), clamped
/// to the effort's min and max.
int referenceViews(const ReproduceScene& scene, std::size_t aperture,
                   const ReproduceEffort& effort);

/// Frames that `measureScene` renders. A frame of N views counts N times.
std::size_t framesToMeasure(const ReproduceScene& scene, const ReproduceEffort& effort,
                            const std::vector<unsigned>& threads);

/// @param threads    numbers of threads to measure with, rising; the last is all threads
/// @param on_frames  called with the number of frames rendered since the last call
SceneResult measureScene(const ReproduceScene& scene, const ReproduceEffort& effort,
                         const std::vector<unsigned>& threads,
                         const std::function<void(std::size_t)>& on_frames);

/// table1.csv.
std::string csvOf(const std::vector<ReproduceRow>& rows);

}  // namespace foci
