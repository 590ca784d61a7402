// The reproduction of the 2003 paper: its scenes, accuracy and time of each method on them, the
// figures that it is judged by, and its page. First the scenes of Table 1 and Figure 6: the
// textured plane and the lion, each with its view, its focus and its apertures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "app/graphics/image.h"
#include "render/image/frame.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

inline constexpr std::size_t kApertures = 3;  // a pinhole, a small aperture, a large one

/// A row of the paper's Table 1 (512 x 512, c = 2.5, Pentium 4 at 1.4 GHz).
struct PaperRow {
  std::size_t aperture;     ///< 0, 1, 2
  const char* aperture_as;  ///< in the paper's units
  bool lod;
  double kfragments, points, seconds;
};

struct ReproduceScene : SceneInView {
  std::array<double, kApertures> apertures_m{};  ///< diameters; the first is 0
  std::array<PaperRow, 5> paper;
  double paper_reference_s;  ///< time of the paper's 200 views

  RenderSettings settingsAt(std::size_t aperture) const {
    return settingsThrough(apertures_m[aperture]);
  }
  double largestBlur_px(std::size_t aperture) const {
    return largestBlurThrough_px(apertures_m[aperture]);
  }
};

/// The paper's plane with its apertures: see `planeInView`. @param samples  surfels along a side
ReproduceScene planeScene(int samples = 512);

/// The procedural lion, without apertures.
ReproduceScene statueScene();

/// A scan in place of the lion, without apertures.
/// @throws InputError as `scanInView`
ReproduceScene scanScene(const ScanView& scan);

/// Chooses the scene's apertures: with them, fragments of method `paper` grow as the paper's
/// fragments do on its lion. Where blur dominates, fragments are proportional to the square of the
/// aperture; a secant search in the square takes a few steps.
/// @param on_frame  called after every rendered frame
/// @throws InputError if no aperture reaches the paper's growth
void chooseApertures(ReproduceScene& scene, const std::function<void()>& on_frame);

// Accuracy and time of each method on a scene at each aperture.

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

// The figures that the reproduction is judged by: ratios of times, and accuracy.

struct Growth {
  struct Size {
    std::size_t surfels = 0;
    double build_s = 0.0;
    double bytes_per_surfel = 0.0;  ///< without the scene itself
    std::array<double, kApertures> ms_median{};
  };
  Size before, after;

  /// Frame time after over frame time before: the max over the apertures.
  double frameTime() const;
};

inline constexpr int kGrowthRuns = 5;

/// Measures `sweep-lod` on planes of about a tenth of `surfels`, and of about `surfels`.
/// @param on_frame  called after every frame
Growth measureGrowth(std::size_t surfels, const std::function<void()>& on_frame);

/// One figure of one scene.
struct ReproduceRatio {
  std::string key;   ///< for programs
  std::string what;  ///< for people
  std::string scene;
  std::string paper;  ///< the paper's own figure; empty if the paper states none
  double value;       ///< the worst over the rows; may be infinite
  double wanted;
  bool at_most;  ///< true: `wanted` is an upper bound; false: a lower bound
  int digits;

  bool reached() const { return at_most ? value <= wanted : value >= wanted; }
};

/// The figures of one scene. Ratios of times compare medians with the same number of threads:
///   sweep-lod at the largest aperture over sweep-lod without blur,
///   paper-lod over sweep-lod at each aperture,
///   accumulate:200 over sweep-lod at the largest aperture.
/// @param rows      all rows of the scene
/// @param is_plane  true: the plane; false: the lion, which has other bounds
std::vector<ReproduceRatio> ratiosOf(const std::vector<ReproduceRow>& rows, bool is_plane);

/// The figures of a grown scene: time to build the larger hierarchy, its memory, and `frameTime`.
std::vector<ReproduceRatio> ratiosOf(const Growth& growth);

// The reproduction as a page: the figures to reach, Table 1 beside the paper's own numbers, Figures
// 1 and 6.

/// An <svg> element in the page's colours, with logarithmic time.
/// @param threads  selects the rows
std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads);

/// An image with its caption.
struct PaperFigure {
  Image image;
  std::string caption;
};

/// Figure 1: a half-transparent mask before a bust. Focus lies on the mask, between the two, and on
/// the bust.
/// @param views      of the references
/// @param on_frames  called with the number of frames rendered since the last call
std::vector<PaperFigure> figure1(const SurfelCloud& gallery, int views,
                                 const std::function<void(std::size_t)>& on_frames);

/// Figure 6: a row for each aperture, with foci's frame, the reference, and their difference.
std::vector<std::vector<PaperFigure>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result);

struct ReproducedScene {
  ReproduceScene scene;
  SceneResult result;
  std::vector<std::vector<PaperFigure>> figure6;
};

struct ReproduceFacts {
  std::vector<ReproducedScene> scenes = {};  ///< the plane, then the lion
  std::vector<ReproduceRatio> ratios = {};
  std::vector<PaperFigure> figure1 = {};
  std::optional<Growth> growth = {};
  ReproduceEffort effort;
  std::vector<unsigned> threads;
  double seconds = 0.0;
  bool quick = false;  ///< the page does not judge a quick run
};

/// A complete HTML page, with its images inside.
std::string reproducePage(const ReproduceFacts& facts);

}  // namespace foci
