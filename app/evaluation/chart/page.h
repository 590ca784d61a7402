// The chart on one page: what to use when, time against accuracy, every image a click away.
#pragma once

#include <filesystem>

#include "app/evaluation/chart/measure.h"

namespace foci {

/// @throws std::runtime_error where the file cannot be written
void writeChartPage(const std::filesystem::path& file, const ChartPlan& plan,
                    const std::vector<ChartPoint>& points);

}  // namespace foci
