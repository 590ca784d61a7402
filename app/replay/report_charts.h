// The charts of the report, which gnuplot renders as SVG.
#pragma once

#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/figure.h"
#include "app/study/session_settings_of.h"
#include "app/study/study.h"
#include "base/thinned.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A key that took another value at a frame of the run.
struct SettingChange {
  double time_s = 0.0;
  std::string key;
  std::string from, to;  ///< as JSON; "null": absent
};

struct RunChanges {
  Study start;                         ///< in force at the first frame
  std::vector<SettingChange> changes;  ///< after it, in order of time
  std::vector<TraceMarker> markers;    ///< from the first frame to the last
};

/// @param changes  in order of time; those before the first frame go into `start`
RunChanges changesOfRun(const Study& study, const std::vector<Change>& changes,
                        const std::vector<TraceMarker>& markers, double first_s, double last_s);

/// "observer.pupil_mm 2, 4, 8; eye.position_m 245 times": each key with its values, or how often it
/// changed. Empty without changes.
std::string changesText(const std::vector<SettingChange>& changes);

/// The values of a key: at the start, then after each change. Empty if it never changed.
std::vector<std::string> valuesOf(const std::vector<SettingChange>& changes,
                                  const std::string& key);

/// A line or label on the time axis: an event marker or a change.
struct RunMark {
  double time_s = 0.0;
  bool is_change = false;
  std::string text;  ///< plain
};

/// Changes and markers in order of time.
std::vector<RunMark> marksOf(const RunChanges& run);

/// A table of the marks, numbered as in the charts; empty without marks.
std::string marksTable(const std::vector<RunMark>& marks);

/// What the charts show of a frame; NaN: absent.
struct ChartRow {
  double time_s, gaze_x_px, gaze_y_px, surface_D, target_D, focus_D, pupil_mm, render_ms;
  GazeState state;
  double vergence_D = std::numeric_limits<double>::quiet_NaN();  ///< of the fixation so far
  glm::dquat world_from_eye{1.0, 0.0, 0.0, 0.0};
};

/// Charts of a headset have gaze in the head as angles, the head's rotation, and vergence.
struct HeadsetAxes {
  Screen screen;  ///< the display's
  glm::dvec3 up;  ///< of the scene, unit
};

using ChartSeries = Thinned<ChartRow, 4000>;

/// A stretch of time in which nothing was recorded.
struct RecordingPause {
  double from_s, to_s;
};
inline constexpr const char* kPauseColor = "#4aa3b8";

/// Gaze, focus, pupil and, if asked for, render time over time, over bands that show the gaze
/// state. Event markers and changes are lines through all panels, numbered at the top.
/// @param rows       not empty
/// @param screen_px  range of the gaze axis
/// @param marks      in order of time
/// @param pauses     are no data loss, and have a colour of their own
/// @param headset    absent: the screen does not move
GnuplotChart timeFigure(const FigureStyle& style, const std::vector<ChartRow>& rows,
                        const glm::ivec2& screen_px, const std::vector<RunMark>& marks,
                        bool render_times, const std::vector<RecordingPause>& pauses = {},
                        const std::optional<HeadsetAxes>& headset = {});

FigureStyle reportStyle();

/// The figure in that style as an <svg> element for a page. Axes have the text colour of the page,
/// so that one image serves light and dark pages.
GnuplotChart chartsSvg(const std::vector<ChartRow>& rows, const glm::ivec2& screen_px,
                       const std::vector<RunMark>& marks,
                       const std::vector<RecordingPause>& pauses = {},
                       const std::optional<HeadsetAxes>& headset = {});

/// What the charts show, in sentences.
std::string chartsText(const std::vector<ChartRow>& rows, const std::vector<RunMark>& marks,
                       bool render_times);

/// Colour of a state in charts and legends, "#rrggbb".
const char* colorOf(GazeState state);

}  // namespace foci
