// The figures of a run, for manifest.json, the report and standard output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace foci {

struct RunSummary {
  std::size_t frames = 0;
  double duration_s = 0.0;  ///< of the video
  double gaze_valid = 0.0;  ///< share of the run's samples that have a gaze point
  std::size_t fixations = 0;
  std::size_t saccades = 0;
  double render_ms_median = 0.0;  ///< of all frames; a reused frame takes 0 ms
  double render_ms_p95 = 0.0;
  std::size_t frames_rendered = 0;  ///< the others were reused
  double rendered_ms_median = 0.0;  ///< of the rendered frames; 0 without any
  double rendered_ms_p95 = 0.0;
  std::uint64_t splats = 0;  ///< in a frame, median
  double pupil_mm = 0.0;     ///< median
  std::filesystem::path out;
};

}  // namespace foci
