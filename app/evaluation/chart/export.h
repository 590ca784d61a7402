// Cases: the scenes, cameras, lenses and references of a chart as files that other renderers read.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"
#include "app/platform/output_files.h"

namespace foci {

/// The width of the sensor that f-numbers refer to: a photographer's full frame.
inline constexpr double kSensorWidth_m = 0.036;

/// A folder of one scene at one blur, relative to the folder of all: "plane/4px".
std::string caseName(const ChartScene& scene, double blur_px);

/// The files that `exportCases` writes.
std::vector<std::filesystem::path> exportedFiles(const ChartPlan& plan,
                                                 const std::filesystem::path& folder);

/// Stages the files; a README.md explains them.
/// @param options  of the plan as the user gave them: the README repeats them for the import
/// @param on_step  called after each reference, of which there is one for each scene and blur
void exportCases(const ChartPlan& plan, const std::string& options, OutputFolder& output,
                 const std::function<void()>& on_step);

}  // namespace foci
