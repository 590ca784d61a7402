#include "app/graphics/drawing.h"

#include <algorithm>

#include "app/graphics/html.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kAdvancePerSize =
    0.56;  // mean width of a letter over the font size, chosen by eye

// Units of gnuplot's pngcairo terminal, matched by eye with the SVG.
constexpr double kPointPerPx = 0.75;     // font size
constexpr double kPointRadius_px = 4.0;  // of a disc of point size 1
constexpr double kMiddlePerSize = 0.33;  // baseline to the middle of the words

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

std::string px(double value) { return decimal(value, 1); }

std::string cssColor(const std::string& color) {
  if (color == kInk) return "var(--ink)";
  if (color == kQuiet) return "var(--quiet)";
  if (color == kFaint) return "var(--line)";
  return color;
}

std::string paperColor(const std::string& color) {
  if (color == kInk) return "#1d2127";
  if (color == kQuiet) return "#626a75";
  if (color == kFaint) return "#e3e4e6";
  return color;
}

const char* svgAnchor(Anchor anchor) {
  return anchor == Anchor::start ? "start" : anchor == Anchor::middle ? "middle" : "end";
}

const char* gnuplotAnchor(Anchor anchor) {
  return anchor == Anchor::start ? "left" : anchor == Anchor::middle ? "center" : "right";
}

std::string svgDisc(const DrawnDisc& disc) {
  std::string svg = "<circle" + attribute("cx", px(disc.at_px.x)) +
                    attribute("cy", px(disc.at_px.y)) + attribute("r", px(disc.radius_px)) +
                    attribute("stroke", cssColor(disc.color)) +
                    attribute("fill", disc.hollow ? "var(--card)" : cssColor(disc.color));
  if (disc.title.empty()) {
    svg += "/>";
  } else {
    svg += "><title>" + escaped(disc.title) + "</title></circle>";
  }
  if (disc.link.empty()) return svg + "\n";
  return "<a" + attribute("href", escaped(disc.link)) +
         (disc.data.empty() ? "" : attribute("data-at", escaped(disc.data))) + ">" + svg + "</a>\n";
}

}  // namespace

void Drawing::add(const Drawing& other, const glm::dvec2& by_px) {
  for (DrawnLine line : other.lines) {
    for (glm::dvec2& point : line.points_px) point += by_px;
    lines.push_back(std::move(line));
  }
  for (DrawnDisc disc : other.discs) {
    disc.at_px += by_px;
    discs.push_back(std::move(disc));
  }
  for (DrawnText text : other.texts) {
    text.at_px += by_px;
    texts.push_back(std::move(text));
  }
}

double textWidth_px(const std::string& words, double size_px) {
  return kAdvancePerSize * size_px * static_cast<double>(words.size());
}

std::string svgOf(const Drawing& drawing) {
  // The children of an image do not exist for a screen reader.
  const bool links =
      std::ranges::any_of(drawing.discs, [](const DrawnDisc& disc) { return !disc.link.empty(); });
  std::string svg =
      "<svg" +
      attribute("viewBox",
                "0 0 " + decimal(drawing.size_px.x, 0) + " " + decimal(drawing.size_px.y, 0)) +
      attribute("role", links ? "group" : "img") + " font-family=\"system-ui, sans-serif\"";
  if (!drawing.title.empty()) svg += attribute("aria-label", escaped(drawing.title));
  svg += ">\n";
  if (!drawing.title.empty()) svg += "<title>" + escaped(drawing.title) + "</title>\n";
  if (!drawing.description.empty()) svg += "<desc>" + escaped(drawing.description) + "</desc>\n";
  for (const DrawnLine& line : drawing.lines) {
    std::string points;
    for (const glm::dvec2& at : line.points_px) points += px(at.x) + "," + px(at.y) + " ";
    svg += "<polyline fill=\"none\"" + attribute("points", points) +
           attribute("stroke", cssColor(line.color)) +
           attribute("stroke-width", px(line.width_px)) +
           (line.dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
  }
  for (const DrawnDisc& disc : drawing.discs) svg += svgDisc(disc);
  for (const DrawnText& text : drawing.texts) {
    svg += "<text" + attribute("x", px(text.at_px.x)) + attribute("y", px(text.at_px.y)) +
           attribute("text-anchor", svgAnchor(text.anchor)) +
           attribute("fill", cssColor(text.color)) + attribute("font-size", px(text.size_px)) +
           (text.bold ? " font-weight=\"600\"" : "") + ">" + escaped(text.words) + "</text>\n";
  }
  return svg + "</svg>\n";
}

GnuplotChart pngOf(const Drawing& drawing) {
  const std::string width = decimal(drawing.size_px.x, 0), height = decimal(drawing.size_px.y, 0);
  std::string script = "set terminal pngcairo size " + width + "," + height +
                       " noenhanced font 'sans,12' background rgb '#ffffff'\n"
                       "unset border\nunset tics\nunset key\n"
                       "set lmargin at screen 0\nset rmargin at screen 1\n"
                       "set tmargin at screen 1\nset bmargin at screen 0\n"
                       "set xrange [0:" +
                       width + "]\nset yrange [" + height + ":0]\n";
  std::string blocks, plots;
  int count = 0;
  const auto plot = [&](const std::string& data, const std::string& style) {
    const std::string name = "$shape" + std::to_string(count++);
    blocks += name + " << END\n" + data + "END\n";
    plots += (count == 1 ? "plot " : ", ") + name + " " + style;
  };
  for (const DrawnLine& line : drawing.lines) {
    std::string points;
    for (const glm::dvec2& at : line.points_px) points += px(at.x) + " " + px(at.y) + "\n";
    plot(points, "using 1:2 with lines linewidth " + px(line.width_px) + " linecolor rgb '" +
                     paperColor(line.color) + "'" + (line.dashed ? " dashtype 2" : ""));
  }
  for (const DrawnDisc& disc : drawing.discs) {
    plot(px(disc.at_px.x) + " " + px(disc.at_px.y) + "\n",
         "using 1:2 with points pointtype " + std::string(disc.hollow ? "6" : "7") + " pointsize " +
             decimal(disc.radius_px / kPointRadius_px, 3) + " linewidth 1.2" + " linecolor rgb '" +
             paperColor(disc.color) + "'");
  }
  for (const DrawnText& text : drawing.texts) {
    script += "set label " + gnuplotString(text.words) + " at " + px(text.at_px.x) + "," +
              px(text.at_px.y - kMiddlePerSize * text.size_px) + " " + gnuplotAnchor(text.anchor) +
              " font 'sans" + (text.bold ? " Bold" : "") + "," + px(kPointPerPx * text.size_px) +
              "' textcolor rgb '" + paperColor(text.color) + "' front\n";
  }
  return runGnuplot(blocks + script + plots + "\n");
}

}  // namespace foci
