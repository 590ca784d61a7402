#include "app/graphics/plot.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace foci {
namespace {

// Margins, sizes and gaps, px; chosen by eye.
constexpr double kLeft = 58.0, kRight = 14.0, kNamesRight = 236.0, kTop = 12.0, kTitleTop = 34.0;
constexpr double kBottom = 44.0, kUntitledBottom = 28.0;
constexpr double kText_px = 12.0, kLabel_px = 11.0, kTitle_px = 14.0;
constexpr double kNameGap_px = 15.0;
constexpr double kDisc_px = 4.0;
constexpr int kMaxTicks = 7;

/// The part of a drawing between the axes.
struct Area {
  glm::dvec2 low, high;  // px; y downwards
  const Plot& plot;

  static double share(const PlotAxis& axis, double value) {
    value = std::clamp(value, axis.from, axis.to);
    return axis.logarithmic ? std::log(value / axis.from) / std::log(axis.to / axis.from)
                            : (value - axis.from) / (axis.to - axis.from);
  }
  double x(double value) const { return low.x + (high.x - low.x) * share(plot.x, value); }
  double y(double value) const { return high.y - (high.y - low.y) * share(plot.y, value); }
  glm::dvec2 at(const PlotPoint& point) const { return {x(point.x), y(point.y)}; }
};

/// The bounds of a text, a disc or a line.
struct Box {
  glm::dvec2 low, high;
  bool meets(const Box& other) const {
    return glm::all(glm::lessThan(low, other.high)) && glm::all(glm::lessThan(other.low, high));
  }
};

void drawAxes(const Area& area, Drawing& drawing) {
  const Plot& plot = area.plot;
  for (const PlotTick& tick : plot.y.ticks) {
    const double y = area.y(tick.at);
    drawing.lines.push_back({{{area.low.x, y}, {area.high.x, y}}, kFaint});
    drawing.texts.push_back({{area.low.x - 8.0, y + 4.0}, tick.text, Anchor::end});
  }
  for (const PlotTick& tick : plot.x.ticks) {
    const double x = area.x(tick.at);
    if (plot.x.logarithmic) {
      drawing.lines.push_back({{{x, area.low.y}, {x, area.high.y}}, kFaint});
    }
    drawing.texts.push_back({{x, area.high.y + 17.0}, tick.text, Anchor::middle});
  }
  if (!plot.x.title.empty()) {
    drawing.texts.push_back(
        {{area.high.x, plot.size_px.y - 8.0}, plot.x.title, Anchor::end, kQuiet, kText_px});
  }
  if (!plot.y.title.empty()) {
    drawing.texts.push_back({{area.low.x + 4.0, area.low.y - 4.0}, plot.y.title, Anchor::start});
  }
  if (!plot.title.empty()) {
    drawing.texts.push_back({{8.0, 16.0}, plot.title, Anchor::start, kInk, kTitle_px, true});
  }
}

/// Puts a label at the first free place around its point; leaves it out if there is none.
void placeLabel(const glm::dvec2& at, const PlotPoint& point, const std::string& color,
                const Area& area, std::vector<Box>& taken, Drawing& drawing) {
  const double width = textWidth_px(point.label, kLabel_px), out = kDisc_px + 3.0;
  struct Place {
    glm::dvec2 off;  // from the point to the start of the baseline
    double before;   // share of the width that lies left of that start
  };
  const std::array<Place, 10> places = {{{{-out, -out + 2.0}, 1.0},
                                         {{out, 4.0}, 0.0},
                                         {{-out, 4.0}, 1.0},
                                         {{0.0, -out - 1.0}, 0.5},
                                         {{0.0, out + 8.0}, 0.5},
                                         {{out, -out + 2.0}, 0.0},
                                         {{out, out + 6.0}, 0.0},
                                         {{-out, out + 6.0}, 1.0},
                                         {{out, out + 18.0}, 0.0},
                                         {{-out, out + 18.0}, 1.0}}};
  for (const Place& place : places) {
    const glm::dvec2 start = at + place.off - glm::dvec2(place.before * width, 0.0);
    const Box box{start - glm::dvec2(0.0, kLabel_px - 1.0), start + glm::dvec2(width, 2.0)};
    if (box.low.x < area.low.x || box.high.x > area.high.x || box.low.y < area.low.y ||
        box.high.y > area.high.y) {
      continue;
    }
    if (std::ranges::any_of(taken, [&](const Box& one) { return one.meets(box); })) {
      continue;
    }
    taken.push_back(box);
    drawing.texts.push_back({start, point.label, Anchor::start, color, kLabel_px});
    return;
  }
}

}  // namespace

PlotAxis linearAxis(std::string title, const std::vector<double>& values) {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  assert(min <= max);
  const double span = std::max(max - min, 1e-6);
  double step = std::pow(10.0, std::floor(std::log10(span)) - 1.0);
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5, 2.0}) {
    if (span / step <= kMaxTicks) break;
    step *= factor;
  }
  PlotAxis axis{.title = std::move(title),
                .from = step * std::floor(min / step),
                .to = step * std::ceil(max / step)};
  if (axis.to <= axis.from) axis.to = axis.from + step;
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double at = axis.from; at < axis.to + 0.5 * step; at += step) {
    axis.ticks.push_back({at, decimal(at, digits)});
  }
  return axis;
}

namespace {

/// An axis of powers of ten that covers all values, > 0 (asserted).
template <class TextOf>
PlotAxis powersOfTen(std::string title, const std::vector<double>& values, const TextOf& textOf) {
  assert(!values.empty());
  const auto [min, max] = std::ranges::minmax_element(values);
  assert(*min > 0.0);
  const double low = std::floor(std::log10(*min) + 1e-9);
  const double high = std::max(std::ceil(std::log10(*max) - 1e-9), low + 1.0);
  PlotAxis axis{.title = std::move(title),
                .from = std::pow(10.0, low),
                .to = std::pow(10.0, high),
                .logarithmic = true};
  for (double power = low; power <= high; power += 1.0) {
    const double at = std::pow(10.0, power);
    axis.ticks.push_back({at, textOf(at, std::max(0, static_cast<int>(-power)))});
  }
  return axis;
}

}  // namespace

PlotAxis timeAxis(std::string title, const std::vector<double>& ms) {
  return powersOfTen(std::move(title), ms, [](double at, int digits) {
    return at >= 1000.0 ? decimal(at / 1000.0, 0) + " s" : decimal(at, digits) + " ms";
  });
}

PlotAxis logarithmicAxis(std::string title, std::vector<double> values, double min) {
  for (double& value : values) value = std::max(value, min);
  return powersOfTen(std::move(title), values,
                     [](double at, int digits) { return decimal(at, digits); });
}

namespace {

/// Draws the lines and discs of all series. @return the space that they take
std::vector<Box> drawSeries(const Area& area, Drawing& drawing) {
  std::vector<Box> taken;
  for (const PlotSeries& series : area.plot.series) {
    DrawnLine line{.points_px = {},
                   .color = series.color,
                   .width_px = series.width_px,
                   .dashed = series.dashed};
    for (const PlotPoint& point : series.points) {
      const glm::dvec2 at = area.at(point);
      line.points_px.push_back(at);
      if (!series.discs) continue;
      drawing.discs.push_back({.at_px = at,
                               .radius_px = kDisc_px,
                               .color = series.color,
                               .hollow = point.hollow,
                               .title = point.title,
                               .link = point.link,
                               .data = point.data});
      taken.push_back({at - kDisc_px, at + kDisc_px});
    }
    if (!series.line || line.points_px.size() < 2) continue;
    for (std::size_t i = 1; !series.discs && i < line.points_px.size(); ++i) {
      const glm::dvec2 &a = line.points_px[i - 1], &b = line.points_px[i];
      taken.push_back({glm::min(a, b) - 1.0, glm::max(a, b) + 1.0});
    }
    drawing.lines.push_back(std::move(line));
  }
  return taken;
}

/// Draws a level and its text: above or below the line, at its right or left end, at the first of
/// these places that is free.
void drawLevel(const PlotLevel& level, const Area& area, std::vector<Box>& taken,
               Drawing& drawing) {
  const double y = area.y(level.y), width = textWidth_px(level.text, kLabel_px);
  drawing.lines.push_back({{{area.low.x, y}, {area.high.x, y}}, kQuiet, 1.2, true});
  const double right = area.high.x - width, left = area.low.x + 4.0;
  Box words{};
  for (const glm::dvec2& start : {glm::dvec2(right, y - 4.0), glm::dvec2(right, y + 12.0),
                                  glm::dvec2(left, y - 4.0), glm::dvec2(left, y + 12.0)}) {
    words = {start - glm::dvec2(0.0, kLabel_px), start + glm::dvec2(width, 2.0)};
    if (std::ranges::none_of(taken, [&](const Box& one) { return one.meets(words); })) {
      break;
    }
  }
  const bool at_right = words.low.x == right;
  drawing.texts.push_back({{at_right ? area.high.x : left, words.high.y - 2.0},
                           level.text,
                           at_right ? Anchor::end : Anchor::start,
                           kQuiet,
                           kLabel_px});
  taken.push_back(words);
  taken.push_back({{area.low.x, y - 1.0}, {area.high.x, y + 1.0}});
}

/// Labels the points; full points get their places first.
void drawLabels(const Area& area, std::vector<Box>& taken, Drawing& drawing) {
  for (const bool hollow : {false, true}) {
    for (const PlotSeries& series : area.plot.series) {
      for (const PlotPoint& point : series.points) {
        if (point.hollow != hollow || point.label.empty()) continue;
        placeLabel(area.at(point), point, series.color, area, taken, drawing);
      }
    }
  }
}

/// Writes the names of the series at the right ends of their lines, pushed apart.
void drawEndLabels(const Area& area, Drawing& drawing) {
  std::vector<std::pair<double, const PlotSeries*>> names;
  for (const PlotSeries& series : area.plot.series) {
    if (!series.points.empty()) names.emplace_back(area.at(series.points.back()).y, &series);
  }
  std::ranges::sort(names, [](const auto& a, const auto& b) { return a.first < b.first; });
  double free_y = 0.0;
  for (auto& [y, series] : names) {
    y = std::max(y, free_y);
    free_y = y + kNameGap_px;
  }
  // Push names that leave the image back up from its lower edge.
  free_y = area.plot.size_px.y - 8.0;
  for (auto name = names.rbegin(); name != names.rend(); ++name) {
    name->first = std::min(name->first, free_y);
    free_y = name->first - kNameGap_px;
  }
  for (const auto& [y, series] : names) {
    drawing.texts.push_back(
        {{area.high.x + 14.0, y + 4.0}, series->name, Anchor::start, series->color, kText_px});
  }
}

std::string axisText(const std::string& letter, const PlotAxis& axis) {
  std::string text = letter + (axis.title.empty() ? "" : ": " + axis.title);
  if (axis.ticks.size() > 1) {
    text += ", from " + axis.ticks.front().text + " to " + axis.ticks.back().text;
  }
  return text + ". ";
}

/// A value as the axis would write it: a tick's own text, or with the ticks' unit of time.
std::string valueText(const PlotAxis& axis, double value) {
  bool time = false;
  for (const PlotTick& tick : axis.ticks) {
    if (std::abs(tick.at - value) < 1e-9) return tick.text;
    time |= tick.text.ends_with(" ms") || tick.text.ends_with(" s");
  }
  if (!time) return significant(value, 3);
  return value < 1000.0 ? significant(value, 3) + " ms" : significant(value / 1000.0, 3) + " s";
}

/// The plot in words: axes, levels, and the ends of each series.
std::string descriptionOf(const Plot& plot) {
  std::string text = axisText("Across", plot.x) + axisText("Up", plot.y);
  for (const PlotLevel& level : plot.levels) text += "Line: " + level.text + ". ";
  for (const PlotSeries& series : plot.series) {
    if (series.name.empty() || series.points.empty()) continue;
    const PlotPoint &first = series.points.front(), &last = series.points.back();
    const auto at = [&](const PlotPoint& point) {
      return valueText(plot.y, point.y) + " at " + valueText(plot.x, point.x);
    };
    text += series.name + ": " + at(first);
    if (series.points.size() > 1) {
      text += " to " + at(last) + ", " + std::to_string(series.points.size()) + " points";
    }
    text += ". ";
  }
  return text;
}

}  // namespace

Drawing layOut(const Plot& plot) {
  const Area area{
      .low = {kLeft, (plot.title.empty() ? kTop : kTitleTop) + (plot.y.title.empty() ? 0.0 : 14.0)},
      .high = plot.size_px - glm::dvec2(plot.end_labels ? kNamesRight : kRight,
                                        plot.x.title.empty() ? kUntitledBottom : kBottom),
      .plot = plot};
  Drawing drawing{.size_px = plot.size_px};
  drawing.title = plot.title.empty() ? plot.name : plot.title;
  drawing.description = descriptionOf(plot);
  drawAxes(area, drawing);
  std::vector<Box> taken = drawSeries(area, drawing);
  for (const PlotLevel& level : plot.levels) drawLevel(level, area, taken, drawing);
  drawLabels(area, taken, drawing);
  if (plot.end_labels) drawEndLabels(area, drawing);
  return drawing;
}

Drawing layOut(const std::vector<Plot>& plots, std::size_t across) {
  const glm::dvec2 panel_px = plots.front().size_px;
  Drawing all{.size_px = glm::dvec2(across, (plots.size() + across - 1) / across) * panel_px};
  for (std::size_t i = 0; i < plots.size(); ++i) {
    all.add(layOut(plots[i]), glm::dvec2(i % across, i / across) * panel_px);
  }
  return all;
}

}  // namespace foci
