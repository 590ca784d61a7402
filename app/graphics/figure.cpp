#include "app/graphics/figure.h"

#include <algorithm>
#include <cstdint>

#include "app/graphics/html.h"

namespace foci {
namespace {

// Margins and gaps, multiples of the letters' size; chosen by eye.
constexpr double kPanelLeft = 6.2, kPanelRight = 1.2, kPanelTop = 2.4, kPanelBottom = 4.4,
                 kPanelGap = 2.1, kStrip = 5.2;
// Radius of a point of size 1 in gnuplot's terminals: measured, with cairo in points or px.
constexpr double kSvgPointPerFont = 0.375, kCairoPoint = 3.05;

/// Units of the terminal in a point.
double unitsPerPoint(const FigureStyle& style) {
  return style.format == FigureFormat::png ? style.dpi / 72.0 : 1.0;
}

std::string terminalOf(const FigureStyle& style) {
  const glm::dvec2 size = unitsPerPoint(style) * style.size_pt();
  const std::string font = decimal(style.font_pt, 2) + "'";
  const std::string units = decimal(size.x, 0) + "," + decimal(size.y, 0);
  if (style.format == FigureFormat::svg) {
    return "svg size " + units + " dynamic standalone font 'sans-serif," + font + " name 'foci'";
  }
  if (style.format == FigureFormat::pdf) {  // its letters are 4/3 of what they are said to be
    return "pdfcairo size " + decimal(0.1 * style.width_mm, 3) + "cm," +
           decimal(0.1 * style.height_mm, 3) + "cm fontscale 0.75 font 'Sans," + font;
  }
  return "pngcairo size " + units + " fontscale " + decimal(style.dpi / 96.0, 4) + " font 'Sans," +
         font;
}

/// Gives gnuplot's <svg> element size, role, title and description in place of its own.
void describe(std::string& svg, const FigureStyle& style, const std::string& title,
              const std::string& description) {
  svg.insert(svg.find('>'), " width=\"" + decimal(style.width_mm, 3) + "mm\" height=\"" +
                                decimal(style.height_mm, 3) + "mm\" role=\"img\" aria-label=\"" +
                                escaped(title) + "\"");
  const std::size_t from = svg.find("<desc>"), to = svg.find("</desc>");
  if (from != svg.npos && to != svg.npos) svg.erase(from, to + 7 - from);
  svg =
      replaced(std::move(svg), "<title>foci</title>",
               "<title>" + escaped(title) + "</title>\n<desc>" + escaped(description) + "</desc>");
}

std::string ofScreen(const char* side, double share) {
  return std::string("set ") + side + "margin at screen " + decimal(share, 4) + "\n";
}

}  // namespace

std::string FigureStyle::line(double multiple) const {
  const double pdf = format == FigureFormat::pdf ? 2.0 : 1.0;  // its lines are half as wide
  return decimal(multiple * line_pt * pdf * unitsPerPoint(*this), 3);
}

std::string FigureStyle::point(double radius_pt) const {
  const double unit = format == FigureFormat::svg ? kSvgPointPerFont * font_pt : kCairoPoint;
  return decimal(radius_pt * unitsPerPoint(*this) / unit, 3);
}

std::string figureHead(const FigureStyle& style) {
  const std::string ink = "textcolor rgb '" + style.ink + "'";
  return "set encoding utf8\nset terminal " + terminalOf(style) + "\nset border 3 linecolor rgb '" +
         style.ink + "' linewidth " + style.line(0.5) + "\nset tics nomirror " + ink +
         "\nset ylabel " + ink + "\nset xlabel " + ink + "\nset key " + ink + " noenhanced\n";
}

GnuplotChart drawFigure(const FigureStyle& style, const std::string& script,
                        const std::string& title, const std::string& description) {
  GnuplotChart chart = runGnuplot(script);
  if (!chart.image || style.format != FigureFormat::svg) return chart;
  std::string& svg = *chart.image;
  const std::size_t start = svg.find("<svg");
  if (start == svg.npos || svg.find('>', start) == svg.npos) {
    return {.problem = "gnuplot drew no SVG"};
  }
  svg.erase(0, start);
  describe(svg, style, title, description);
  return chart;
}

glm::dvec2 panelSides(const FigureStyle& style) {
  const double font = style.font_pt / style.size_pt().x;
  return {kPanelLeft * font, 1.0 - kPanelRight * font};
}

std::string stackedPanels(const FigureStyle& style, const std::string& x_label,
                          const std::vector<FigurePanel>& panels) {
  const glm::dvec2 sides = panelSides(style);
  const double font = style.font_pt / style.size_pt().y;
  double heights = 0.0;
  for (const FigurePanel& panel : panels) heights += panel.height;
  const double gaps = kPanelGap * static_cast<double>(panels.size() - 1);
  const double share = (1.0 - (kPanelTop + kPanelBottom + gaps) * font) / heights;
  std::string script = "set multiplot\nset format x ''\n" + ofScreen("l", sides.x) +
                       ofScreen("r", sides.y) +
                       "set key vertical maxrows 1 at graph 1, graph 1 right bottom samplen 1.5\n";
  double top = 1.0 - kPanelTop * font;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const FigurePanel& panel = panels[i];
    const double bottom = top - share * panel.height;
    script += ofScreen("b", bottom) + ofScreen("t", top) + "set ylabel '" + panel.label + "'\n";
    if (i + 1 == panels.size()) script += "set format x '%g'\nset xlabel '" + x_label + "'\n";
    script += panel.settings + "plot " + panel.plots + "\n" + panel.after;
    top = bottom - kPanelGap * font;
  }
  return script + "unset multiplot\n";
}

FigureStyle styleFor(FigureStyle style, const glm::ivec2& image_px) {
  style.height_mm = style.width_mm * image_px.y / image_px.x + kStrip * style.font_pt * kMmPerPoint;
  return style;
}

std::string pictureScript(const FigureStyle& style, const FigurePicture& picture) {
  const glm::dvec2 size = picture.size, font = style.font_pt / style.size_pt();
  const glm::ivec2 image_px = picture.image.size_px;
  const glm::dvec2 step = size / glm::dvec2(image_px);
  const auto pair = [](double x, double y) { return exactText(x) + "," + exactText(y); };
  const FigureScale& scale = picture.scale;
  const auto color = [&](double share) {
    const auto at = static_cast<float>(share);
    return hexOf(scale.heat ? heatAt(style.colors, at, 0.0f) : colorAt(style.colors, at));
  };
  constexpr int kSteps = 16;
  std::string palette;
  for (int i = 0; i <= kSteps; ++i) {
    palette += (i > 0 ? ", " : "") + std::to_string(i) + " '" +
               color(static_cast<double>(i) / kSteps) + "'";
  }
  const double strip = kStrip * font.y;
  std::string script =
      ofScreen("l", 0.0) + ofScreen("r", 1.0) + ofScreen("b", strip) + ofScreen("t", 1.0) +
      "unset tics\nunset border\nset xrange [0:" + exactText(size.x) + "]\nset yrange [" +
      exactText(size.y) + ":0]\n" + "set palette defined (" + palette + ")\nset cbrange [" +
      exactText(scale.from) + ":" + exactText(scale.to) + "]\nset cbtics ('" +
      scale.text(scale.from) + "' " + exactText(scale.from) + ", '" + scale.text(scale.to) + "' " +
      exactText(scale.to) + ") scale 0.4 offset 0,0.4 textcolor rgb '" + style.ink +
      "'\nset colorbox horizontal user origin screen 0.5, screen " + decimal(0.52 * strip, 4) +
      " size screen 0.43, screen " + decimal(0.25 * strip, 4) + " front noborder\nset label " +
      gnuplotString(scale.label) + " at screen 0.715, screen " + decimal(0.13 * strip, 4) +
      " center textcolor rgb '" + style.ink + "' noenhanced\n" + picture.settings;
  if (picture.bar) {
    const double from = 0.02, to = from + *picture.bar / size.x, y = 0.64 * strip;
    script += "set arrow from screen " + decimal(from, 4) + ", screen " + decimal(y, 4) +
              " to screen " + decimal(to, 4) + ", screen " + decimal(y, 4) + " nohead linewidth " +
              style.line(3.0) + " linecolor rgb '" + style.ink + "' front\nset label " +
              gnuplotString(picture.bar_label) + " at screen " + decimal(from, 4) + ", screen " +
              decimal(0.26 * strip, 4) + " left textcolor rgb '" + style.ink + "'\n";
  }
  script += "plot '-' binary array=(" + std::to_string(image_px.x) + "," +
            std::to_string(image_px.y) + ") dx=" + exactText(step.x) + " dy=" + exactText(step.y) +
            " origin=(" + pair(0.5 * step.x, 0.5 * step.y) +
            ") format='%uchar' using 1:2:3 with rgbimage notitle, NaN with points palette notitle" +
            picture.plots + "\n";
  script.append(picture.image.rgb.begin(), picture.image.rgb.end());
  return script;
}

namespace {

constexpr std::size_t kStops = 10;
constexpr std::array<std::array<std::uint32_t, kStops>, 4> kCodes{{
    {0x000004, 0x1b0c41, 0x4a0c6b, 0x781c6d, 0xa52c60, 0xcf4446, 0xed6925, 0xfb9b06, 0xf7d13d,
     0xfcffa4},
    {0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b,
     0xfde725},
    {0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55,
     0xfee838},
    {0x000000, 0x1c1c1c, 0x393939, 0x555555, 0x717171, 0x8e8e8e, 0xaaaaaa, 0xc6c6c6, 0xe3e3e3,
     0xffffff},
}};
constexpr float kLeastHeat = 0.25f;  // place on the map where heat begins

float onMap(float share) { return kLeastHeat + (1.0f - kLeastHeat) * share; }

}  // namespace

glm::vec3 colorAt(ColorMap map, float share) {
  const float at = static_cast<float>(kStops - 1) * std::clamp(share, 0.0f, 1.0f);
  const auto low = std::min(static_cast<std::size_t>(at), kStops - 2);
  const auto code = [&](std::size_t stop) {
    const std::uint32_t rgb = kCodes.at(static_cast<std::size_t>(map)).at(stop);
    return glm::vec3(rgb >> 16U, (rgb >> 8U) & 255U, rgb & 255U) / 255.0f;
  };
  return glm::mix(code(low), code(low + 1), at - static_cast<float>(low));
}

std::string hexOf(const glm::vec3& code) {
  const glm::uvec3 byte(glm::round(255.0f * glm::clamp(code, 0.0f, 1.0f)));
  return printed("#%02x%02x%02x", byte.r, byte.g, byte.b);
}

glm::vec3 heatAt(ColorMap map, float share, float grey) {
  if (!(share > 0.0f)) return glm::vec3(grey);
  return glm::mix(glm::vec3(grey), colorAt(map, onMap(share)), std::min(8.0f * share, 1.0f));
}

}  // namespace foci
