// Points and lines over two axes, laid out with their labels: what every chart of figures shares.
#pragma once

#include <string>
#include <vector>

#include "app/graphics/drawing.h"

namespace foci {

struct PlotTick {
  double at;
  std::string text;
};

struct PlotAxis {
  std::string title = {};
  double from = 0.0, to = 1.0;  ///< `from` < `to`; both > 0 where logarithmic
  bool logarithmic = false;
  std::vector<PlotTick> ticks = {};
};

/// Round steps that hold all of the values, finite ones counted. At least one must be (asserted).
PlotAxis linearAxis(std::string title, const std::vector<double>& values);

/// Times in milliseconds: powers of ten that hold all of the values. All > 0 (asserted).
PlotAxis timeAxis(std::string title, const std::vector<double>& ms);

/// Powers of ten that hold all of the values, those below `least` > 0 counted as it.
PlotAxis logarithmicAxis(std::string title, std::vector<double> values, double least);

struct PlotPoint {
  double x = 0.0, y = 0.0;  ///< beyond the axes: drawn at their ends
  std::string label = {};   ///< beside it, where there is room
  bool hollow = false;
  std::string title = {}, link = {}, data = {};  ///< as of a DrawnDisc
};

struct PlotSeries {
  std::string name = {};  ///< at the end of its line, where `end_labels`
  std::string color = {};
  std::vector<PlotPoint> points = {};
  bool line = true;  ///< from point to point
  bool discs = true;
  bool dashed = false;
  double width_px = 1.4;
};

/// A value that nothing passes, or is to reach.
struct PlotLevel {
  double y = 0.0;
  std::string text = {};
};

struct Plot {
  std::string title = {};
  PlotAxis x = {}, y = {};
  std::vector<PlotSeries> series = {};
  std::vector<PlotLevel> levels = {};
  bool end_labels = false;  ///< the series' names in a column on the right
  glm::dvec2 size_px{600.0, 360.0};
};

Drawing layOut(const Plot& plot);

}  // namespace foci
