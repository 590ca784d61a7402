// Two or more runs side by side: one page and one table.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/replay/finished_run.h"

namespace foci {

/// A run's folder, read back.
struct ComparedRun {
  std::filesystem::path folder;
  std::string name;  ///< the folder's
  std::size_t fixations = 0;
  std::vector<RunFrame> frames = {};           ///< times after the first frame
  std::map<std::string, double> dwell_s = {};  ///< by object
  std::vector<Image> pictures = {};            ///< of the video, at `kPictures` equal steps

  /// The last frame lasts as long as the others do on average. 0 for a single frame.
  double duration_s() const;
  double meanFocus_D() const;
  double meanPupil_mm() const;
  /// Diameter of the blur disc of what is looked at, arcmin: mean of pupil times defocus. Absent
  /// if no surface was looked at.
  std::optional<double> meanBlur_arcmin() const;
};

inline constexpr std::size_t kPictures = 6;

/// @throws InputError if the folder is not that of a replay
ComparedRun readRun(const std::filesystem::path& folder);

/// compare.tsv: one row for each run.
std::string compareTable(const std::vector<ComparedRun>& runs);

/// compare.html: figures, dwell times, focus over time, and pictures with their difference from
/// those of the first run.
std::string comparePage(const std::vector<ComparedRun>& runs);

/// Files of a comparison in `out`.
std::vector<std::filesystem::path> compareFiles(const std::filesystem::path& out);

/// Reads the runs and writes both files. @throws InputError, std::runtime_error
void compareRuns(const std::vector<std::filesystem::path>& folders,
                 const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
