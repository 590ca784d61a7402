// What a reader of report.html can do without a server: choose a trial, click on a fixation or a
// plot to move the video there, and read values under the pointer.
#pragma once

#include <string>
#include <vector>

#include "app/replay/report_charts.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

extern const char* const kExplorerStyle;

/// A list of the trials to choose from, each with its spans of time; "" for a run without trials.
std::string trialChoice(const std::vector<TraceTrial>& trials);

/// A row for each fixation, with its trial and time for the script.
/// @param table  the text of fixations.tsv
std::string fixationRows(const std::string& table);

/// The script, with the values of the charts: numbers alone, so that no name can be a command.
/// @param rows    the run's frames; the first is the video's first
/// @param screen  of their points
std::string explorerScript(const std::vector<ChartRow>& rows, const Screen& screen);

/// The choice of the recording's clock or time from zero, for charts and for elements with
/// `data-time`.
std::string clockChoice();

}  // namespace foci
