#include "app/replay/report_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/graphics/html.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMaxRows = 4000;
constexpr const char* kTextColor =
    "#010203";  // stands for the page's text colour until the SVG is done

std::string field(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "NaN";
}

std::string dataBlock(const std::vector<ChartRow>& rows) {
  std::string text = "$frames << END\n";
  for (const ChartRow& row : rows) {
    text += field(row.time_s, 4) + ' ' + field(row.gaze_x_px, 1) + ' ' + field(row.gaze_y_px, 1) +
            ' ' + field(row.surface_D, 4) + ' ' + field(row.target_D, 4) + ' ' +
            field(row.focus_D, 4) + ' ' + field(row.pupil_mm, 3) + ' ' + field(row.render_ms, 2) +
            '\n';
  }
  return text + "END\n";
}

/// The state of each stretch of time, as filled rectangles behind every panel.
std::string stateBand(const std::vector<ChartRow>& rows) {
  std::string text;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= rows.size(); ++i) {
    if (i < rows.size() && rows[i].state == rows[begin].state) continue;
    if (rows[begin].state != GazeState::fixation) {
      const double end_s = i < rows.size() ? rows[i].time_s : rows.back().time_s;
      text += "set object rectangle from " + decimal(rows[begin].time_s, 4) + ", graph 0 to " +
              decimal(std::max(end_s, rows[begin].time_s + 1e-4), 4) +
              ", graph 1 behind fillstyle solid 0.22 noborder fillcolor rgb '" +
              colorOf(rows[begin].state) + "'\n";
    }
    begin = i;
  }
  return text;
}

/// The marks as vertical lines: dashed where a setting changed. Numbers stand in the first panel,
/// where there is room.
/// @param labels  the script that removes the numbers again
std::string markLines(const std::vector<RunMark>& marks, double from_s, double to_s,
                      std::string& labels) {
  constexpr double kWidth_px = 870.0, kLabel_px = 16.0, kLine_px = 1.0;
  const double px_per_s = kWidth_px / (to_s - from_s);
  std::string text;
  double last_line_s = -1e300, last_label_s = -1e300;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const RunMark& mark = marks[i];
    if ((mark.time_s - last_line_s) * px_per_s < kLine_px) continue;
    last_line_s = mark.time_s;
    const std::string at = decimal(mark.time_s, 4);
    // gnuplot's SVG keeps the dashes of the last line unless the width differs, too.
    text.append("set arrow from ").append(at).append(", graph 0 to ").append(at);
    text.append(", graph 1 nohead ")
        .append(mark.is_change ? "linewidth 0.9 dashtype 2" : "linewidth 1.2 dashtype 1")
        .append(" linecolor rgb '")
        .append(kTextColor)
        .append("'\n");
    if ((mark.time_s - last_label_s) * px_per_s < kLabel_px) continue;
    last_label_s = mark.time_s;
    const std::string number = std::to_string(i + 1);
    text.append("set label ").append(number).append(" '").append(number).append("' at ").append(at);
    text.append(", graph 0.93 left offset 0.3,0 font 'sans-serif,11' textcolor rgb '")
        .append(kTextColor)
        .append("' front\n");
    labels.append("unset label ").append(number).append("\n");
  }
  return text;
}

std::string panel(double bottom, double top, const std::string& label, const std::string& more) {
  return "set bmargin at screen " + decimal(bottom, 4) + "\nset tmargin at screen " +
         decimal(top, 4) + "\nset ylabel '" + label + "'\n" + more;
}

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

const char* colorOf(GazeState state) {
  switch (state) {
    case GazeState::fixation:
      return "#3a9d6e";
    case GazeState::saccade:
    case GazeState::oscillation:
      return "#d9822b";
    case GazeState::pursuit:
      return "#8e6bbf";
    case GazeState::blink:
      return "#7a8190";
    case GazeState::lost:
      return "#c94a4a";
    case GazeState::unjudged:
      return "#b8a04a";
  }
  return "#c94a4a";
}

void ChartSeries::add(const ChartRow& row) {
  if (seen_++ % stride_ != 0) return;
  rows_.push_back(row);
  if (rows_.size() < kMaxRows) return;
  for (std::size_t i = 0; 2 * i < rows_.size(); ++i) rows_[i] = rows_[2 * i];
  rows_.resize((rows_.size() + 1) / 2);
  stride_ *= 2;
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

/// Gives gnuplot's <svg> element a role, a title and a description in place of its own.
void describe(std::string& svg, const std::string& title, const std::string& description) {
  const std::size_t start = svg.find('>');
  svg.insert(start, " role=\"img\" aria-label=\"" + escaped(title) + "\"");
  for (const auto& [tag, text] :
       {std::pair<std::string, std::string>("title", title), {"desc", description}}) {
    const std::string open = "<" + tag + ">", close = "</" + tag + ">";
    const std::size_t from = svg.find(open), to = svg.find(close);
    const std::string element = std::string(open).append(escaped(text)).append(close);
    if (from != svg.npos && to != svg.npos) {
      svg.replace(from, to + close.size() - from, element);
    } else {
      svg.insert(svg.find('>') + 1, "\n" + element);
    }
  }
}

}  // namespace

std::string chartsText(const std::vector<ChartRow>& rows, const std::vector<RunMark>& marks) {
  const auto changes = static_cast<std::size_t>(std::count_if(
      marks.begin(), marks.end(), [](const RunMark& mark) { return mark.is_change; }));
  const std::size_t markers = marks.size() - changes;
  return "Four panels over time, from " + decimal(rows.front().time_s, 2) + " s to " +
         decimal(rows.back().time_s, 2) + " s. Gaze, horizontal " +
         rangeOf(rows, &ChartRow::gaze_x_px, 0) + " px and vertical " +
         rangeOf(rows, &ChartRow::gaze_y_px, 0) + " px. Focus of the eye, " +
         rangeOf(rows, &ChartRow::focus_D, 2) + " dioptres, beside the surface under the gaze, " +
         rangeOf(rows, &ChartRow::surface_D, 2) + " dioptres. Pupil, " +
         rangeOf(rows, &ChartRow::pupil_mm, 1) + " mm. Time to render a frame, " +
         rangeOf(rows, &ChartRow::render_ms, 1) + " ms. " + counted(markers, "event marker") +
         " and " + counted(changes, "change") + " of settings.";
}

GnuplotChart chartsSvg(const std::vector<ChartRow>& rows, const glm::ivec2& screen_px,
                       const std::vector<RunMark>& marks) {
  const double from_s = rows.front().time_s;
  const double to_s = std::max(rows.back().time_s, from_s + 1e-3);
  std::string script = dataBlock(rows);
  script +=
      "set terminal svg size 960,900 dynamic font 'sans-serif,13' name 'foci'\n"
      "set multiplot\nset lmargin at screen 0.08\nset rmargin at screen 0.985\n"
      "set border 3 linecolor rgb '" +
      std::string(kTextColor) +
      "' linewidth 0.7\n"
      "set tics nomirror textcolor rgb '" +
      kTextColor + "'\nset ylabel textcolor rgb '" + kTextColor +
      "' offset 1,0\nset xlabel textcolor rgb '" + kTextColor + "'\nset key textcolor rgb '" +
      kTextColor +
      "' horizontal at graph 1, graph 1.02 right bottom samplen 2\nset format x ''\n"
      "set xrange [" +
      decimal(from_s, 6) + ":" + decimal(to_s, 6) + "]\n";
  script += stateBand(rows);
  std::string no_labels;
  script += markLines(marks, from_s, to_s, no_labels);
  const auto line = [](int column, const char* title, const char* color, const char* width) {
    return "$frames using 1:" + std::to_string(column) + " with lines title '" + title +
           "' linewidth " + width + " linecolor rgb '" + color + "'";
  };
  const int span_px = std::max(screen_px.x, screen_px.y);
  script += panel(0.75, 0.965, "gaze, px", "set yrange [0:" + std::to_string(span_px) + "]\n");
  script += "plot " + line(2, "x", "#3b82c4", "1.4") + ", " + line(3, "y", "#d9822b", "1.4") +
            "\n" + no_labels;
  script += panel(0.44, 0.69, "focus, D", "set yrange [0:*]\n");
  script += "plot " + line(4, "surface under gaze", "#3a9d6e", "3.5") + ", " +
            line(6, "focus of the eye", "#c2417c", "1.6") + "\n";
  script += panel(0.285, 0.38, "pupil, mm", "set yrange [0:9]\nset ytics 4\n");
  script += "plot " + line(7, "", "#8e6bbf", "1.6") + "\n";
  script +=
      panel(0.06, 0.225, "render, ms",
            "set yrange [0:*]\nset ytics autofreq\nset format x '%g'\nset xlabel 'time, s'\n");
  // A reused frame has no impulse.
  script +=
      "plot $frames using 1:8 with impulses title '' linewidth 1.2 linecolor rgb '#7a8190'\n"
      "unset multiplot\n";

  GnuplotChart chart = runGnuplot(script);
  if (!chart.image) return chart;
  std::string& svg = *chart.image;
  const std::size_t start = svg.find("<svg");
  if (start == svg.npos || svg.find('>', start) == svg.npos) {
    return {.problem = "gnuplot drew no SVG"};
  }
  svg.erase(0, start);
  // Not currentColor: gnuplot's groups set that to black.
  for (const char* drawn : {kTextColor, "rgb(  1,   2,   3)", "rgb(1,2,3)"}) {
    replaceAll(svg, drawn, "var(--ink)");
  }
  describe(svg, "Gaze, focus, pupil and render time over time", chartsText(rows, marks));
  return chart;
}

}  // namespace foci
