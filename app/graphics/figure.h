// Figures that gnuplot draws for the report and for papers: their size, letters and lines, panels
// above each other, and a picture with its scales beneath.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"
#include "app/platform/gnuplot.h"
#include "base/text.h"

namespace foci {

// Colour maps whose steps look equal: inferno and viridis (van der Walt and Smith 2015), cividis
// (Nunez, Anderton and Renslow 2018), and grey.

enum class ColorMap { inferno, viridis, cividis, grey };

/// The names, in the order of `ColorMap`.
inline constexpr std::array<const char*, 4> kColorMaps{"inferno", "viridis", "cividis", "grey"};

/// The colour at a share, 0 to 1 from dark to bright: sRGB codes over 255.
glm::vec3 colorAt(ColorMap map, float share);

/// "#rrggbb" of sRGB codes over 255.
std::string hexOf(const glm::vec3& code);

/// How heat covers a grey ground: little heat lets it show. The scale begins above the map's dark
/// end, which looks like a dim scene.
/// @param share  of the scale's end; 0: only ground
/// @param grey   of the ground, sRGB code over 255
glm::vec3 heatAt(ColorMap map, float share, float grey);

enum class FigureFormat { svg, pdf, png };

/// The names, in the order of `FigureFormat`; also the endings of the files.
inline constexpr std::array<const char*, 3> kFigureFormats{"svg", "pdf", "png"};

inline constexpr double kMmPerPoint = 25.4 / 72.0;

struct FigureStyle {
  FigureFormat format = FigureFormat::svg;
  double width_mm = 180.0, height_mm = 110.0;
  double font_pt = 8.0, line_pt = 0.75;
  double dpi = 300.0;  ///< of PNG, and of the pictures in a figure
  ColorMap colors = ColorMap::inferno;
  std::string ink = "#000000";

  glm::dvec2 size_pt() const { return glm::dvec2(width_mm, height_mm) / kMmPerPoint; }
  /// Line width and point size for gnuplot: multiples of `line_pt`, and a radius in points.
  std::string line(double multiple) const;
  std::string point(double radius_pt) const;
};

/// Commands that begin each figure.
std::string figureHead(const FigureStyle& style);

/// Runs the commands. An SVG begins with its element, whose size is that of the style, and speaks
/// to screen readers.
/// @param title, description  what it is, and what it shows
GnuplotChart drawFigure(const FigureStyle& style, const std::string& script,
                        const std::string& title, const std::string& description);

struct FigurePanel {
  std::string label;
  double height = 1.0;  ///< relative to the others
  std::string settings{}, plots{};
  std::string after{};  ///< commands once it is drawn
};

/// Panels over one axis.
std::string stackedPanels(const FigureStyle& style, const std::string& x_label,
                          const std::vector<FigurePanel>& panels);

/// Left and right end of the panels, shares of the figure's width.
glm::dvec2 panelSides(const FigureStyle& style);

/// A bar of colours; `heat`: the colours of `heatAt`, else the whole map.
struct FigureScale {
  double from = 0.0, to = 1.0;
  std::string label{};
  bool heat = true;
  std::string beyond{};  ///< before the end of the scale: a sign that values may exceed it

  std::string text(double value) const {
    return (value == to ? beyond : "") + significant(value, 3);
  }
};

/// A picture across the figure, with a strip for scales below.
struct FigurePicture {
  Image image;
  glm::dvec2 size;  ///< of the image in the coordinates of bar and plots; y downwards
  FigureScale scale;
  std::optional<double> bar{};  ///< its length; absent: none
  std::string bar_label{};
  std::string settings{}, plots{};  ///< more; `plots` begins with a comma
};

/// The style with the height that the picture needs.
FigureStyle styleFor(FigureStyle style, const glm::ivec2& image_px);

std::string pictureScript(const FigureStyle& style, const FigurePicture& picture);

}  // namespace foci
