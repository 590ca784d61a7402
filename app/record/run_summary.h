// The figures that a run ends with: in manifest.json, in the report and on standard output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace foci {

struct RunSummary {
  std::size_t frames = 0;
  double duration_s = 0.0;  ///< of the video
  double gaze_valid = 0.0;  ///< share of the samples replayed that have a gaze point
  std::size_t fixations = 0;
  std::size_t saccades = 0;
  double render_ms_median = 0.0;  ///< of all frames; one that is not rendered takes none
  double render_ms_p95 = 0.0;
  std::size_t frames_rendered = 0;  ///< the others would have shown nothing new
  double rendered_ms_median = 0.0;  ///< of those rendered; 0 where there are none
  double rendered_ms_p95 = 0.0;
  std::uint64_t splats = 0;  ///< in a frame, median
  double pupil_mm = 0.0;     ///< median
  std::filesystem::path out;
};

}  // namespace foci
