// Time against accuracy: one scene at one blur and number of threads; every method is a point. The
// page of all panels.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"
#include "app/evaluation/chart/points.h"
#include "app/graphics/plot.h"

namespace foci {

/// The accuracy that a panel shows.
enum class ChartMeasure {
  psnr,        ///< over the image
  silhouette,  ///< over the pixels that a step in depth blurs into
};

/// The frontier is that of the measure shown.
/// @param points  of one scene, blur and number of threads; at least one has the measure
Plot panelOf(const std::vector<ChartPoint>& points, ChartMeasure measure, const std::string& title);

/// All scenes at one blur in one image, with the machine's name: for pages without links.
Drawing overviewOf(const ChartPlan& plan, const std::vector<ChartPoint>& points, double blur_px);

/// A complete HTML page: which method to use when, the panels, and every image as a link. Its links
/// are relative to the chart's folder.
std::string chartPage(const ChartPlan& plan, const Measured<ChartPoint>& measured);

}  // namespace foci
