// What a reader of report.html can do without a server: choose a trial, click on a fixation or a
// plot to move the video there, and read values under the pointer.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "app/replay/report_charts.h"
#include "app/replay/scene_view.h"
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

// The view of the scene in three dimensions, with plan and side view: WebGL 2 and no library, so
// that the page opens from disk, offline, and stays small.

extern const char* const kSceneStyle;

/// The section. Its script follows `explorerScript` in the page.
/// @param first_s  time at which the video begins, on the recording's clock
/// @param last_s   and ends
void writeSceneSection(std::ostream& out, const SceneView& view, double first_s, double last_s);

/// The script, with the points and lines: numbers alone.
void writeSceneScript(std::ostream& out, const SceneView& view, double first_s);

}  // namespace foci
