// The heatmap of a run: how long gaze rested on each surfel, or Gaussian, of the scene.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "app/graphics/figure.h"
#include "app/graphics/video_writer.h"
#include "app/replay/gaze_in_scene.h"
#include "render/scene/scene.h"

namespace foci {

struct HeatPicture {
  std::string caption;
  Image image;
};

struct HeatMap {
  /// The scene in dim grey, with attention in the colours of `heatAt`. Gaussians have no tree.
  Scene scene;
  /// Attention per area at the end of the scale, which 1 % of the time exceeds; 0: there is none.
  double most_s_per_m2 = 0.0;
};

/// @param gaze  with attention
HeatMap heatMapOf(const Scene& scene, const GazeInScene& gaze, ColorMap colors = ColorMap::inferno);

/// The scale of colours with its unit, as HTML.
std::string heatBarHtml(double most_s_per_m2);

/// Pictures from where the observer was on average, and from the side, turned by 60 degrees about
/// the middle of what was looked at. `GazeInScene::up` is upwards. None if no gaze met the scene.
std::vector<HeatPicture> heatPictures(const Scene& heat, const GazeInScene& gaze,
                                      const glm::ivec2& size_px = {720, 480});

/// A PLY of the surfels or Gaussians: position, normal of a surfel, colour of `heat`, and
/// `attention_s`, seconds.
/// @throws std::runtime_error
void writeHeatPly(const std::filesystem::path& file, const Scene& heat,
                  const std::vector<double>& attention_s);

}  // namespace foci
