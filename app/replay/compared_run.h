// A run's folder, read back for a comparison.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"

namespace foci {

/// A frame of frames.tsv.
struct ComparedFrame {
  double time_s = 0.0;  ///< after the first frame
  double focus_D = 0.0;
  double pupil_mm = 0.0;
  std::optional<double> off_focus_D = {};  ///< |1 / surface - focus|; absent without a surface
};

struct ComparedRun {
  std::filesystem::path folder;
  std::string name;  ///< the folder's
  std::size_t fixations = 0;
  std::vector<ComparedFrame> frames = {};
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

inline constexpr int kPictures = 6;

/// @throws InputError if the folder is not that of a replay
ComparedRun readRun(const std::filesystem::path& folder);

}  // namespace foci
