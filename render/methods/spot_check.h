// What a way to render a frame gets wrong, found out on small squares of it: what the scene in view
// makes of a way, which no table of blurs can know.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {

/// Squares of one frame: 48 tiles, spread evenly over the view, or the view as one where it has not
/// twice as many. They bring what 95 % of the pixels are apart by to 20 %, 16 to half or twice.
class SpotCheck {
 public:
  /// @param scene  keeps its buffers between frames
  /// @param finest  what ways are held against
  SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
            const LodSettings& finest);

  /// What 95 % of the squares' pixels are apart by from the finest way, in just noticeable
  /// differences at 40 pixels a degree (visible_difference.h).
  /// @param limit  what that is to be compared with: 16 squares suffice where it is clearly more,
  ///               or clearly less; then it is what it may be at most
  float error(const LodSettings& way, float limit);

 private:
  struct Square {
    glm::ivec2 corner_px, size_px;
    Frame finest = {};  ///< rendered when it is asked for
  };
  Frame render(const Square& square, const LodSettings& way);

  LodSplats& scene_;
  View view_;
  RenderSettings settings_;
  LodSettings finest_;
  std::vector<Square> squares_;
};

}  // namespace foci
