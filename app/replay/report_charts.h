// The charts of the report, which gnuplot renders as SVG.
#pragma once

#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/figure.h"
#include "app/replay/run_changes.h"
#include "base/thinned.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

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

/// Rows for the charts.
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
