// Images that other renderers made of exported cases, with their times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/evaluation/chart/plan.h"
#include "app/evaluation/chart/points.h"
#include "app/graphics/image.h"
#include "app/platform/output_files.h"
#include "render/image/frame.h"

namespace foci {

/// A point of the chart, with its images.
struct ImportedPoint {
  ChartPoint point;
  Image image{}, difference{};
  std::vector<std::filesystem::path> read{};  ///< the files
};

/// Reads `times.json` in a folder of exported cases, and the images that it lists, and scores them.
/// @throws InputError for the first thing that is wrong: an entry, an image, a sharp image that
/// shows another view, a case of another plan
std::vector<ImportedPoint> importPoints(const ChartPlan& plan, const std::filesystem::path& folder);

/// The files that `writeImages` writes.
std::vector<std::filesystem::path> importedFiles(const std::vector<ImportedPoint>& points,
                                                 const std::filesystem::path& folder);

/// Stages the image of each point, and its difference from the reference.
void writeImages(const std::vector<ImportedPoint>& points, OutputFolder& output);

/// What is wrong with a sharp image: shifted, mirrored, in another gamma, or of another view. Empty
/// if it agrees as well as the images of two renderers do. The frames have one size (asserted).
std::string cameraFault(const Frame& sharp, const Frame& expected);

}  // namespace foci
