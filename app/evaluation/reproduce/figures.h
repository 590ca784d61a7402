// Figures 1 and 6 of the 2003 paper, rendered by foci.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"
#include "app/graphics/image.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// An image with its caption.
struct FigurePanel {
  Image image;
  std::string caption;
};

/// Figure 1: a half-transparent mask before a bust. Focus lies on the mask, between the two, and on
/// the bust.
/// @param views      of the references
/// @param on_frames  called with the number of frames rendered since the last call
std::vector<FigurePanel> figure1(const SurfelCloud& gallery, int views,
                                 const std::function<void(std::size_t)>& on_frames);

/// Figure 6: a row for each aperture, with foci's frame, the reference, and their difference.
std::vector<std::vector<FigurePanel>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result);

}  // namespace foci
