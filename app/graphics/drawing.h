// Lines, discs and words, as SVG for a page or as a PNG file.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

/// A colour "#rrggbb", or a role that follows the page's: light or dark.
inline constexpr const char* kInk = "ink";      ///< text
inline constexpr const char* kQuiet = "quiet";  ///< lesser text
inline constexpr const char* kFaint = "faint";  ///< grids

struct DrawnLine {
  std::vector<glm::dvec2> points_px;
  std::string color;
  double width_px = 1.0;
  bool dashed = false;
};

/// On a page, one with a `title` or a `link` answers to the pointer.
struct DrawnDisc {
  glm::dvec2 at_px;
  double radius_px;
  std::string color;
  bool hollow = false;
  std::string title = {};  ///< what is shown under the pointer
  std::string link = {};   ///< what opens
  std::string data = {};   ///< for the page's own script
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

/// Origin top-left. Lines lie under discs, discs under words.
struct Drawing {
  glm::dvec2 size_px;
  std::vector<DrawnLine> lines = {};
  std::vector<DrawnDisc> discs = {};
  std::vector<DrawnText> texts = {};

  /// Adds another drawing's shapes, moved.
  void add(const Drawing& other, const glm::dvec2& by_px);
};

/// About how wide words are in a sans serif face.
double textWidth_px(const std::string& words, double size_px);

/// An <svg> element that takes the page's colours.
std::string svgOf(const Drawing& drawing);

/// A PNG file's bytes on white ground, drawn by gnuplot; nothing where that is not installed.
/// @throws std::runtime_error where gnuplot fails
std::optional<std::string> pngOf(const Drawing& drawing);

}  // namespace foci
