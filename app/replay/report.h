// report.html: everything of a replay on one page that opens from disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/replay/replay.h"
#include "app/replay/report_charts.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// An image of the contact sheet.
struct SheetImage {
  double time_s = 0.0;
  GazeState state = GazeState::lost;
  double focus_D = 0.0;
  std::optional<double> surface_distance_m;
  std::vector<std::uint8_t> jpeg;
};

struct ReportFacts {
  RunSummary summary;
  std::vector<ChartRow> rows;  ///< not empty
  std::vector<SheetImage> sheet;
  std::size_t samples = 0, samples_lost = 0, samples_blink = 0;  ///< of those replayed
  double longest_loss_s = 0.0;
  std::size_t frames_held = 0;  ///< in a blink or a loss, pauses of the recording included
  std::size_t frames_over = 0;  ///< in which method auto expects to err by more than the tolerance
  double first_over_s = 0.0;    ///< the first of them
  double worst_error = 0.0;     ///< that it expects, just noticeable differences
  unsigned threads = 0;
};

/// What `frames_over` means to a reader, in one sentence; "" where there are none.
std::string toleranceText(const Study& study, const ReportFacts& facts);

/// @param video  embedded, read block by block
/// @return whether the charts are in: false where gnuplot is not installed, which the page then
/// says
/// @throws std::runtime_error
bool writeReport(const std::filesystem::path& file, const std::filesystem::path& video,
                 const Study& study, const GazeTrace& trace, const ReportFacts& facts);

}  // namespace foci
