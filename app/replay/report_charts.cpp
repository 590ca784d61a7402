#include "app/replay/report_charts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/replay/gaze_in_scene.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

constexpr const char* kTextColor =
    "#010203";  // stands for the page's text colour until the SVG is done

std::string field(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "NaN";
}

/// Vergence; azimuth and elevation of gaze in the head; those of the head, and its tilt to the
/// right shoulder. Degrees; an angle of the head goes on beyond half a turn.
std::string headsetFields(const ChartRow& row, const HeadsetAxes& axes, double& last_deg) {
  const glm::dvec3 right = row.world_from_eye * glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 top = row.world_from_eye * glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec2 gaze_deg = azimuthElevation_deg(
      lineOfSight(axes.screen, {row.gaze_x_px, row.gaze_y_px}), {0.0, 1.0, 0.0});
  glm::dvec2 head_deg =
      azimuthElevation_deg(row.world_from_eye * glm::dvec3(0.0, 0.0, -1.0), axes.up);
  head_deg.x += 360.0 * std::round((last_deg - head_deg.x) / 360.0);
  last_deg = head_deg.x;
  const double tilt_rad = std::atan2(-glm::dot(right, axes.up), glm::dot(top, axes.up));
  std::string text = ' ' + field(row.vergence_D, 4);
  for (const double angle_deg :
       {gaze_deg.x, gaze_deg.y, head_deg.x, head_deg.y, glm::degrees(tilt_rad)}) {
    text += ' ' + field(angle_deg, 2);
  }
  return text;
}

std::string dataBlock(const std::vector<ChartRow>& rows,
                      const std::optional<HeadsetAxes>& headset) {
  std::string text = "$frames << END\n";
  double last_deg = 0.0;
  for (const ChartRow& row : rows) {
    text += field(row.time_s, 4) + ' ' + field(row.gaze_x_px, 1) + ' ' + field(row.gaze_y_px, 1) +
            ' ' + field(row.surface_D, 4) + ' ' + field(row.target_D, 4) + ' ' +
            field(row.focus_D, 4) + ' ' + field(row.pupil_mm, 3) + ' ' + field(row.render_ms, 2) +
            (headset ? headsetFields(row, *headset, last_deg) : "") + '\n';
  }
  return text + "END\n";
}

/// The state of each stretch of time, as filled rectangles behind every panel.
std::string stateBand(const std::vector<ChartRow>& rows,
                      const std::vector<RecordingPause>& pauses) {
  std::string text;
  const auto band = [&](double from_s, double to_s, const char* color) {
    text += "set object rectangle from " + decimal(from_s, 4) + ", graph 0 to " +
            decimal(std::max(to_s, from_s + 1e-4), 4) +
            ", graph 1 behind fillstyle solid 0.22 noborder fillcolor rgb '" + color + "'\n";
  };
  for (const RecordingPause& pause : pauses) band(pause.from_s, pause.to_s, kPauseColor);
  const auto isPaused = [&](double time_s) {
    return std::ranges::any_of(pauses, [&](const RecordingPause& pause) {
      return pause.from_s <= time_s && time_s < pause.to_s;
    });
  };
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= rows.size(); ++i) {
    const bool paused = isPaused(rows[begin].time_s);
    if (i < rows.size() && rows[i].state == rows[begin].state &&
        isPaused(rows[i].time_s) == paused) {
      continue;
    }
    if (rows[begin].state != GazeState::fixation && !paused) {
      band(rows[begin].time_s, i < rows.size() ? rows[i].time_s : rows.back().time_s,
           colorOf(rows[begin].state));
    }
    begin = i;
  }
  return text;
}

/// The marks as vertical lines: dashed where a setting changed. Numbers stand in the first panel,
/// where there is room.
/// @param labels  the script that removes the numbers again
std::string markLines(const FigureStyle& style, const std::vector<RunMark>& marks, double from_s,
                      double to_s, std::string& labels) {
  constexpr double kLabel_pt = 16.0, kLine_pt = 1.0;
  const glm::dvec2 sides = panelSides(style);
  const double pt_per_s = style.size_pt().x * (sides.y - sides.x) / (to_s - from_s);
  std::string text;
  double last_line_s = -1e300, last_label_s = -1e300;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const RunMark& mark = marks[i];
    if ((mark.time_s - last_line_s) * pt_per_s < kLine_pt) continue;
    last_line_s = mark.time_s;
    const std::string at = decimal(mark.time_s, 4);
    // gnuplot's SVG keeps the dashes of the last line unless the width differs, too.
    text.append("set arrow from ").append(at).append(", graph 0 to ").append(at);
    text.append(", graph 1 nohead linewidth ")
        .append(style.line(mark.is_change ? 0.6 : 0.8))
        .append(mark.is_change ? " dashtype 2" : " dashtype 1")
        .append(" linecolor rgb '")
        .append(style.ink)
        .append("'\n");
    if ((mark.time_s - last_label_s) * pt_per_s < kLabel_pt) continue;
    last_label_s = mark.time_s;
    const std::string number = std::to_string(i + 1);
    text.append("set label ").append(number).append(" '").append(number).append("' at ").append(at);
    text.append(", graph 0.93 left offset 0.3,0 textcolor rgb '")
        .append(style.ink)
        .append("' front\n");
    labels.append("unset label ").append(number).append("\n");
  }
  return text;
}

/// The states on which the ground is coloured, as entries of the key.
std::string stateKeys(const std::vector<ChartRow>& rows) {
  std::string text;
  for (std::size_t i = 0; i < kGazeStates; ++i) {
    const auto state = static_cast<GazeState>(i);
    if (state == GazeState::fixation) continue;
    if (std::ranges::none_of(rows, [&](const ChartRow& row) { return row.state == state; })) {
      continue;
    }
    text += ", NaN with boxes fillstyle solid 0.22 noborder linecolor rgb '" +
            std::string(colorOf(state)) + "' title '" + std::string(nameOf(state)) + "'";
  }
  return text;
}

}  // namespace

const char* colorOf(GazeState state) {
  constexpr std::array<const char*, kGazeStates> kColors{"#3a9d6e", "#d9822b", "#d9822b", "#8e6bbf",
                                                         "#7a8190", "#c94a4a", "#b8a04a"};
  return kColors.at(static_cast<std::size_t>(state));
}

namespace {

/// "0.50 to 2.00"; "no value" if all are absent.
std::string rangeOf(const std::vector<ChartRow>& rows, double ChartRow::*member, int digits) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ChartRow& row : rows) {
    if (!std::isfinite(row.*member)) continue;
    low = std::min(low, row.*member);
    high = std::max(high, row.*member);
  }
  return low <= high ? decimal(low, digits) + " to " + decimal(high, digits) : "no value";
}

}  // namespace

std::string chartsText(const std::vector<ChartRow>& rows, const std::vector<RunMark>& marks,
                       bool render_times) {
  const auto changes = static_cast<std::size_t>(std::ranges::count_if(marks, &RunMark::is_change));
  const std::size_t markers = marks.size() - changes;
  return "Panels over time, from " + decimal(rows.front().time_s, 2) + " s to " +
         decimal(rows.back().time_s, 2) + " s. Gaze, horizontal " +
         rangeOf(rows, &ChartRow::gaze_x_px, 0) + " px and vertical " +
         rangeOf(rows, &ChartRow::gaze_y_px, 0) + " px. Focus of the eye, " +
         rangeOf(rows, &ChartRow::focus_D, 2) + " dioptres, beside the surface under the gaze, " +
         rangeOf(rows, &ChartRow::surface_D, 2) + " dioptres. Pupil, " +
         rangeOf(rows, &ChartRow::pupil_mm, 1) + " mm. " +
         (render_times
              ? "Time to render a frame, " + rangeOf(rows, &ChartRow::render_ms, 1) + " ms. "
              : "") +
         counted(markers, "event marker") + " and " + counted(changes, "change") + " of settings.";
}

GnuplotChart timeFigure(const FigureStyle& style, const std::vector<ChartRow>& rows,
                        const glm::ivec2& screen_px, const std::vector<RunMark>& marks,
                        bool render_times, const std::vector<RecordingPause>& pauses,
                        const std::optional<HeadsetAxes>& headset) {
  const double from_s = rows.front().time_s;
  const double to_s = std::max(rows.back().time_s, from_s + 1e-3);
  std::string no_labels;
  const std::string script = figureHead(style) + dataBlock(rows, headset) + "set xrange [" +
                             decimal(from_s, 6) + ":" + decimal(to_s, 6) + "]\n" +
                             stateBand(rows, pauses) +
                             markLines(style, marks, from_s, to_s, no_labels);
  const auto line = [&](int column, const char* title, const char* color, double width) {
    return "$frames using 1:" + std::to_string(column) + " with lines title '" + title +
           "' linewidth " + style.line(width) + " linecolor rgb '" + color + "'";
  };
  const int span_px = std::max(screen_px.x, screen_px.y);
  int tick_px = 50;
  while (5 * tick_px < span_px) tick_px *= 2;
  const std::string keys = render_times ? "" : stateKeys(rows);
  std::vector<FigurePanel> panels = {
      {.label = "gaze, px",
       .height = 0.215,
       .settings = "set yrange [0:" + std::to_string(span_px) + "]\nset ytics " +
                   std::to_string(tick_px) + "\n",
       .plots = line(2, "x", "#3b82c4", 1.0) + ", " + line(3, "y", "#d9822b", 1.0) + keys,
       .after = no_labels},
      {.label = "focus, D",
       .height = 0.25,
       .settings = "set yrange [0:*]\nset ytics autofreq\n",
       .plots = line(4, "surface under gaze", "#3a9d6e", 2.4) + ", " +
                line(6, "focus of the eye", "#c2417c", 1.1)},
      {.label = "pupil, mm",
       .height = 0.1,
       .settings = "set yrange [0:9]\nset ytics 4\n",
       .plots = line(7, "", "#8e6bbf", 1.1)}};
  if (headset) {
    const std::string degrees = "set yrange [*:*]\nset ytics autofreq\n";
    panels[0].label = "gaze in head, deg";
    panels[0].settings = degrees;
    panels[0].plots =
        line(10, "azimuth", "#3b82c4", 1.0) + ", " + line(11, "elevation", "#d9822b", 1.0) + keys;
    panels[1].plots += ", " + line(9, "vergence of both eyes", "#8e6bbf", 1.0);
    panels.insert(panels.begin() + 1, {.label = "head, deg",
                                       .height = 0.2,
                                       .settings = degrees,
                                       .plots = line(12, "azimuth", "#3b82c4", 1.0) + ", " +
                                                line(13, "elevation", "#d9822b", 1.0) + ", " +
                                                line(14, "tilt to the right", "#8e6bbf", 1.0),
                                       .after = ""});
  }
  if (render_times) {  // a reused frame has no impulse
    panels.push_back({.label = "render, ms",
                      .height = 0.165,
                      .settings = "set yrange [0:*]\nset ytics autofreq\n",
                      .plots = "$frames using 1:8 with impulses title '' linewidth " +
                               style.line(0.8) + " linecolor rgb '#7a8190'"});
  }
  return drawFigure(style, script + stackedPanels(style, "time, s", panels),
                    render_times ? "Gaze, focus, pupil and render time over time"
                                 : "Gaze, focus and pupil over time",
                    chartsText(rows, marks, render_times));
}

FigureStyle reportStyle() {
  return {.width_mm = 960.0 * kMmPerPoint,  // a unit of the SVG is a point
          .height_mm = 900.0 * kMmPerPoint,
          .font_pt = 13.0,
          .line_pt = 1.4,
          .ink = kTextColor};
}

GnuplotChart chartsSvg(const std::vector<ChartRow>& rows, const glm::ivec2& screen_px,
                       const std::vector<RunMark>& marks, const std::vector<RecordingPause>& pauses,
                       const std::optional<HeadsetAxes>& headset) {
  GnuplotChart chart = timeFigure(reportStyle(), rows, screen_px, marks, true, pauses, headset);
  if (!chart.image) return chart;
  // Not currentColor: gnuplot's groups set that to black.
  for (const char* drawn : {kTextColor, "rgb(  1,   2,   3)", "rgb(1,2,3)"}) {
    chart.image = replaced(*chart.image, drawn, "var(--ink)");
  }
  return chart;
}

}  // namespace foci
