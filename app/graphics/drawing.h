// Lines, discs and texts, written as SVG for a page or as a PNG file.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "app/platform/gnuplot.h"

namespace foci {

/// A colour is "#rrggbb", or one of these roles, which follow the page's light or dark style.
inline constexpr const char* kInk = "ink";      ///< text
inline constexpr const char* kQuiet = "quiet";  ///< secondary text
inline constexpr const char* kFaint = "faint";  ///< grids

struct DrawnLine {
  std::vector<glm::dvec2> points_px;
  std::string color;
  double width_px = 1.0;
  bool dashed = false;
};

/// On a page, a disc with a `title` or a `link` responds to the pointer.
struct DrawnDisc {
  glm::dvec2 at_px;
  double radius_px;
  std::string color;
  bool hollow = false;
  std::string title = {};  ///< text under the pointer
  std::string link = {};   ///< target of a click
  std::string data = {};   ///< for the page's script
};

enum class Anchor { start, middle, end };

struct DrawnText {
  glm::dvec2 at_px;  ///< on the baseline
  std::string words;
  Anchor anchor = Anchor::start;
  std::string color = kQuiet;
  double size_px = 12.0;
  bool bold = false;
};

/// The origin is the top-left corner. Lines lie under discs, discs under texts.
struct Drawing {
  glm::dvec2 size_px;
  std::vector<DrawnLine> lines = {};
  std::vector<DrawnDisc> discs = {};
  std::vector<DrawnText> texts = {};
  std::string title = {};        ///< for screen readers: what it is
  std::string description = {};  ///< and what it shows

  /// Adds another drawing's shapes, moved.
  void add(const Drawing& other, const glm::dvec2& by_px);
};

/// Approximate width of words in a sans serif face.
double textWidth_px(const std::string& words, double size_px);

/// An <svg> element in the page's colours, an image for screen readers; a group if it has links.
std::string svgOf(const Drawing& drawing);

/// The bytes of a PNG file on white ground, drawn by gnuplot.
GnuplotChart pngOf(const Drawing& drawing);

}  // namespace foci
