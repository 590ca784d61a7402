// A run's folder, read back for a comparison.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/replay/finished_run.h"

namespace foci {

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

}  // namespace foci
