// The stability suite as a page: how far each dial can be turned, score over dial, and every image
// as a link.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/stability/measure.h"
#include "app/graphics/drawing.h"

namespace foci {

/// A complete HTML page. Its links are relative to the chart's folder.
/// @param notice  of what the page misses; empty: nothing
std::string stabilityPage(const StabilityPlan& plan, const std::vector<StabilityPoint>& points,
                          const std::string& notice);

/// All panels in one image: for pages without links.
Drawing stabilityOverview(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

}  // namespace foci
