// `foci replay`: a recorded gaze goes in, what the eye would have seen comes out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "app/study.h"

namespace foci {

struct ReplaySummary {
  std::size_t frames = 0;
  double duration_s = 0.0;  ///< of the video
  double gaze_valid = 0.0;  ///< share of the samples replayed that have a gaze point
  std::size_t fixations = 0;
  std::size_t saccades = 0;
  double render_ms_median = 0.0;  ///< of all frames; one that is not drawn takes none
  double render_ms_p95 = 0.0;
  std::size_t frames_drawn = 0;  ///< the others would have shown nothing new
  double drawn_ms_median = 0.0;  ///< of those drawn; 0 where there are none
  double drawn_ms_p95 = 0.0;
  std::uint64_t splats = 0;  ///< in a frame, median
  double pupil_mm = 0.0;     ///< median
  std::filesystem::path out;
};

/// Replays the study and writes video.mp4, frames.tsv, events.tsv, manifest.json and report.html to
/// `out`. Nothing is left there, nor the folder if it is new, when it throws.
/// @param command  as typed, for the manifest
/// @param threads  in use, for the manifest
/// @throws InputError, std::runtime_error
ReplaySummary replay(const Study& study, const std::filesystem::path& out,
                     const std::string& command, unsigned threads);

}  // namespace foci
