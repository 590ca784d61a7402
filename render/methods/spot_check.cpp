#include "render/methods/spot_check.h"

#include <algorithm>
#include <cmath>

#include "app/base/quantile.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

constexpr int kSquare_px = kTile, kMostSquares = 16;

/// Corners of tiles that lie in the image whole: all, or those of an even sequence (Roberts's R2).
std::vector<glm::ivec2> cornersIn(const glm::ivec2& size_px) {
  const glm::ivec2 tiles = glm::max(size_px / kSquare_px, 1);
  std::vector<glm::ivec2> corners;
  if (tiles.x * tiles.y <= kMostSquares) {
    for (int y = 0; y < tiles.y; ++y) {
      for (int x = 0; x < tiles.x; ++x) corners.push_back(kSquare_px * glm::ivec2(x, y));
    }
    return corners;
  }
  for (int k = 0; k < kMostSquares; ++k) {
    const glm::dvec2 at =
        glm::fract(0.5 + double{1.0 * k} * glm::dvec2(0.7548776662, 0.5698402910));
    corners.push_back(kSquare_px * glm::ivec2(at * glm::dvec2(tiles)));
  }
  return corners;
}

}  // namespace

SpotCheck::SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
                     const LodSettings& best)
    : scene_(scene), view_(view), settings_(settings), corners_px_(cornersIn(view.size_px)) {
  settings_.depth = false;
  for (const glm::ivec2& corner : corners_px_) best_.push_back(draw(corner, best));
}

Frame SpotCheck::draw(const glm::ivec2& corner_px, const LodSettings& way) {
  View square = view_;
  square.size_px = glm::min(glm::ivec2(kSquare_px), view_.size_px);
  square.principal_px -= glm::vec2(corner_px);
  LodSettings lod = way;
  lod.cut.acuity.gaze_px -= glm::vec2(corner_px);
  Frame frame;
  frame.resize(square.size_px);
  scene_.draw(square, settings_, lod, frame);
  return frame;
}

float SpotCheck::error(const LodSettings& way) {
  std::vector<float> all;
  for (std::size_t i = 0; i < corners_px_.size(); ++i) {
    const auto apart = visibleDifference(draw(corners_px_[i], way), best_[i], kUsualPx_per_deg);
    all.insert(all.end(), apart.begin(), apart.end());
  }
  return quantile(all, 0.95);
}

}  // namespace foci
