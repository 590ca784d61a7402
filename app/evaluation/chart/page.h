// The chart as a page: which method to use when, time against accuracy, and every image as a link.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"
#include "app/evaluation/chart/points.h"

namespace foci {

/// A complete HTML page. Its links are relative to the chart's folder.
std::string chartPage(const ChartPlan& plan, const std::vector<ChartPoint>& points,
                      const std::vector<std::string>& warnings);

}  // namespace foci
