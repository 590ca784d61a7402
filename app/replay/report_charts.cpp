#include "app/replay/report_charts.h"

#include <cmath>
#include <limits>

#include "app/graphics/gnuplot.h"
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

std::optional<std::string> chartsSvg(const std::vector<ChartRow>& rows,
                                     const glm::ivec2& screen_px) {
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
  const auto line = [](int column, const char* title, const char* color, const char* width) {
    return "$frames using 1:" + std::to_string(column) + " with lines title '" + title +
           "' linewidth " + width + " linecolor rgb '" + color + "'";
  };
  const int span_px = std::max(screen_px.x, screen_px.y);
  script += panel(0.75, 0.965, "gaze, px", "set yrange [0:" + std::to_string(span_px) + "]\n");
  script += "plot " + line(2, "x", "#3b82c4", "1.4") + ", " + line(3, "y", "#d9822b", "1.4") + "\n";
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

  auto svg = runGnuplot(script);
  if (!svg) return std::nullopt;
  svg->erase(0, svg->find("<svg"));
  replaceAll(*svg, "#010203", "currentColor");
  replaceAll(*svg, "rgb(  1,   2,   3)", "currentColor");
  replaceAll(*svg, "rgb(1,2,3)", "currentColor");
  return svg;
}

}  // namespace foci
