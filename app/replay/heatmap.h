// The heatmap of a run: how long gaze rested on each surfel of the scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/replay/gaze_in_scene.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// A picture of the heatmap, for the report.
struct HeatPicture {
  std::string caption;
  std::vector<std::uint8_t> jpeg;
};

/// The scene in dim grey, with attention from violet (none) to bright yellow. The scale ends at the
/// attention per area that 1 % of the time exceeds.
/// @param attention_s  by surfel
SurfelCloud heatCloud(const SurfelCloud& cloud, const std::vector<double>& attention_s);

/// Pictures from where the observer was on average, and from the side, turned by 60 degrees about
/// the middle of what was looked at. None if no gaze met the scene.
std::vector<HeatPicture> heatPictures(const SurfelCloud& heat, const GazeInScene& gaze);

/// A PLY of the surfels: position, normal, colour of `heat`, and `attention_s`, seconds.
/// @throws std::runtime_error
void writeHeatPly(const std::filesystem::path& file, const SurfelCloud& heat,
                  const std::vector<double>& attention_s);

}  // namespace foci
