// Points and lines over two axes, laid out with their labels.
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
  double from = 0.0, to = 1.0;  ///< `from` < `to`; both > 0 on a logarithmic axis
  bool logarithmic = false;
  std::vector<PlotTick> ticks = {};
};

/// An axis with round steps that covers all finite values. At least one value is finite (asserted).
PlotAxis linearAxis(std::string title, const std::vector<double>& values);

/// A logarithmic axis in powers of ten that covers times in milliseconds, > 0 (asserted).
PlotAxis timeAxis(std::string title, const std::vector<double>& ms);

/// A logarithmic axis in powers of ten that covers the values. Values below `min` > 0 count as
/// `min`.
PlotAxis logarithmicAxis(std::string title, std::vector<double> values, double min);

struct PlotPoint {
  double x = 0.0, y = 0.0;  ///< values beyond an axis are drawn at its end
  std::string label = {};   ///< beside the point, if there is room
  bool hollow = false;
  std::string title = {}, link = {}, data = {};  ///< as in DrawnDisc
};

struct PlotSeries {
  std::string name = {};  ///< at the end of the line, with `end_labels`
  std::string color = {};
  std::vector<PlotPoint> points = {};
  bool line = true;  ///< joins the points
  bool discs = true;
  bool dashed = false;
  double width_px = 1.4;
};

/// A horizontal line at a value, e.g. a bound.
struct PlotLevel {
  double y = 0.0;
  std::string text = {};
};

struct Plot {
  std::string title = {};
  std::string name = {};  ///< for screen readers, of a plot without title
  PlotAxis x = {}, y = {};
  std::vector<PlotSeries> series = {};
  std::vector<PlotLevel> levels = {};
  bool end_labels = false;  ///< names of the series in a column on the right
  glm::dvec2 size_px{600.0, 360.0};
};

Drawing layOut(const Plot& plot);

/// The plots, at least one and all of one size, side by side in rows of `across`.
Drawing layOut(const std::vector<Plot>& plots, std::size_t across);

}  // namespace foci
