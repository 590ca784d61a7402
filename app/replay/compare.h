// Two or more runs side by side, of one observer with several settings or of several observers:
// one page and one table.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/replay/figures.h"

namespace foci {

/// A run's folder, read back.
struct ComparedRun {
  std::filesystem::path folder;
  std::string name{};   ///< the folder's, with as many of its parents as tell the runs apart
  std::string scene{};  ///< runs of one scene have the same
  std::vector<RunFrame> frames = {};  ///< times after the first frame
  std::vector<RunFixation> fixations = {};
  std::optional<double> median_saccade_deg{};  ///< amplitude
  std::map<std::string, double> dwell_s = {};  ///< by object
  /// Of the video, at `kPictures` equal steps, and where the gaze marker is in them, image px.
  std::vector<Image> pictures = {};
  std::vector<std::optional<glm::dvec2>> markers_px = {};

  /// The last frame lasts as long as the others do on average. 0 for a single frame.
  double duration_s() const;
};

inline constexpr std::size_t kPictures = 6;

/// The runs of a folder: itself, or those of its batch.
std::vector<std::filesystem::path> runFolders(const std::filesystem::path& folder);

/// How much each two observers looked at the same places of the scene, from 0 to 1 (the same): the
/// kernel correlation (Tsin and Kanade 2004), sum_ab g(a, b) over the root of the same sums within
/// each run. g is the integral of the product of two Gaussians on a surface, one about the point of
/// fixation a and one about that of b, weighted by the durations. The sigma of each is
/// `kGazeMapSigma_deg`, seen from the eye. By run and run; nothing for different scenes, or if a
/// run has no fixation on a surface.
using GazeOverlaps = std::vector<std::vector<std::optional<double>>>;
GazeOverlaps gazeOverlaps(const std::vector<ComparedRun>& runs);

/// The difference of two pictures, times `kDifferenceGain`, without the rings that mark gaze.
Image pictureDifference(const ComparedRun& a, const ComparedRun& b, std::size_t picture);

/// compare.tsv: one row for each run.
std::string compareTable(const std::vector<ComparedRun>& runs, const GazeOverlaps& overlaps);

/// compare.html: figures, dwell times, overlap of gaze, focus over time, and pictures with their
/// difference from those of the first run.
std::string comparePage(const std::vector<ComparedRun>& runs, const GazeOverlaps& overlaps);

/// Files of a comparison in `out`.
std::vector<std::filesystem::path> compareFiles(const std::filesystem::path& out);

/// Reads the runs and writes both files. @throws InputError, std::runtime_error
void compareRuns(const std::vector<std::filesystem::path>& folders,
                 const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
