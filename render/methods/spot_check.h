// How far apart two ways to draw a frame are, found out on a few small squares of it: what the
// scene in view makes of a way, which no table of blurs can know.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {

/// Squares of one frame, drawn in the best way when they are made.
class SpotCheck {
 public:
  /// Draws some 16 tiles, spread evenly over the view: all of it where it has no more.
  /// @param scene  keeps its buffers between frames
  SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
            const LodSettings& best);

  /// What 95 % of the squares' pixels are apart by from the best way, in just noticeable
  /// differences at 40 pixels a degree (visible_difference.h).
  float error(const LodSettings& way);

 private:
  Frame draw(const glm::ivec2& corner_px, const LodSettings& way);

  LodSplats& scene_;
  View view_;
  RenderSettings settings_;
  std::vector<glm::ivec2> corners_px_;
  std::vector<Frame> best_;
};

}  // namespace foci
