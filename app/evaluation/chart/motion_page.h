// Motion against time: each scene and path is a panel, and every method a point.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/chart/motion.h"

namespace foci {

/// A complete HTML page. Its links are relative to the chart's folder.
std::string motionPage(const MotionPlan& plan, const std::vector<MotionPoint>& points,
                       const std::vector<std::string>& warnings);

}  // namespace foci
