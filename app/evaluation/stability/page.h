// Where methods give way, on one page: score over dial for each scene, every image a click away.
#pragma once

#include <filesystem>
#include <vector>

#include "app/evaluation/stability/chart.h"
#include "app/graphics/drawing.h"

namespace foci {

/// @throws std::runtime_error where the file cannot be written
void writeStabilityPage(const std::filesystem::path& file, const StabilityPlan& plan,
                        const std::vector<StabilityPoint>& points);

/// All panels in one image, for a page that cannot be clicked.
Drawing stabilityOverview(const StabilityPlan& plan, const std::vector<StabilityPoint>& points);

}  // namespace foci
