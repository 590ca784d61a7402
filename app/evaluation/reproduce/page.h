// The reproduction as a page: the figures to reach, Table 1 beside the paper's own numbers, Figures
// 1 and 6.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"
#include "app/evaluation/reproduce/ratios.h"
#include "app/graphics/image.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// An <svg> element in the page's colours, with logarithmic time.
/// @param threads  selects the rows
std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads);

/// An image with its caption.
struct PaperFigure {
  Image image;
  std::string caption;
};

/// Figure 1: a half-transparent mask before a bust. Focus lies on the mask, between the two, and on
/// the bust.
/// @param views      of the references
/// @param on_frames  called with the number of frames rendered since the last call
std::vector<PaperFigure> figure1(const SurfelCloud& gallery, int views,
                                 const std::function<void(std::size_t)>& on_frames);

/// Figure 6: a row for each aperture, with foci's frame, the reference, and their difference.
std::vector<std::vector<PaperFigure>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result);

struct ReproducedScene {
  ReproduceScene scene;
  SceneResult result;
  std::vector<std::vector<PaperFigure>> figure6;
};

struct ReproduceFacts {
  std::vector<ReproducedScene> scenes = {};  ///< the plane, then the lion
  std::vector<ReproduceRatio> ratios = {};
  std::vector<PaperFigure> figure1 = {};
  std::optional<Growth> growth = {};
  ReproduceEffort effort;
  std::vector<unsigned> threads;
  double seconds = 0.0;
  bool quick = false;  ///< the page does not judge a quick run
};

/// A complete HTML page, with its images inside.
std::string reproducePage(const ReproduceFacts& facts);

}  // namespace foci
