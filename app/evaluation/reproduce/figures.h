// The paper's Figures 1 and 6, drawn by us.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"
#include "app/graphics/image.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// An image with what is to be said below it.
struct FigurePanel {
  Image image;
  std::string caption;
};

/// Figure 1: the half-transparent mask before a figure in the gallery; the mask in focus, a
/// distance in between, the figure.
/// @param views      of the references that it is held against
/// @param on_frames  called after so many frames
std::vector<FigurePanel> drawFigure1(const SurfelCloud& gallery, int views,
                                     const std::function<void(std::size_t)>& on_frames);

/// Figure 6: a row an aperture; ours, the reference, their difference.
std::vector<std::vector<FigurePanel>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result);

}  // namespace foci
