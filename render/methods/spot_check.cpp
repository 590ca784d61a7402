#include "render/methods/spot_check.h"

#include <algorithm>

#include "base/quantile.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

constexpr int kSquare_px = kTile, kSquares = 48, kFirstSquares = 16;

/// What the first squares show may be as many times too little or too much.
constexpr float kClear = 2.0f;

/// Corners of as many tiles that lie in the image whole: those of an even sequence (Roberts's R2).
std::vector<glm::ivec2> cornersIn(const glm::ivec2& tiles, std::size_t count) {
  std::vector<glm::ivec2> corners;
  for (int k = 0; corners.size() < count; ++k) {
    const glm::dvec2 at =
        glm::fract(0.5 + double{1.0 * k} * glm::dvec2(0.7548776662, 0.5698402910));
    const glm::ivec2 corner = kSquare_px * glm::ivec2(at * glm::dvec2(tiles));
    if (std::ranges::find(corners, corner) == corners.end()) corners.push_back(corner);
  }
  return corners;
}

}  // namespace

SpotCheck::SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
                     const LodSettings& finest)
    : scene_(scene), view_(view), settings_(settings), finest_(finest) {
  settings_.depth = false;
  const glm::ivec2 tiles = view.size_px / kSquare_px;
  if (tiles.x * tiles.y < 2 * kSquares) {
    squares_.push_back({glm::ivec2(0), view.size_px});
    return;
  }
  for (const glm::ivec2& corner_px : cornersIn(tiles, kSquares)) {
    squares_.push_back({corner_px, glm::ivec2(kSquare_px)});
  }
}

Frame SpotCheck::render(const Square& square, const LodSettings& way) {
  View view = view_;
  view.size_px = square.size_px;
  view.principal_px -= glm::vec2(square.corner_px);
  LodSettings lod = way;
  lod.cut.acuity.gaze_px -= glm::vec2(square.corner_px);
  Frame frame;
  frame.resize(view.size_px);
  scene_.render(view, settings_, lod, frame);
  return frame;
}

float SpotCheck::error(const LodSettings& way, float limit) {
  std::vector<float> all;
  for (std::size_t i = 0; i < squares_.size(); ++i) {
    Square& square = squares_[i];
    if (square.finest.rgba.empty()) square.finest = render(square, finest_);
    const auto apart = visibleDifference(render(square, way), square.finest, kUsualPx_per_deg);
    all.insert(all.end(), apart.begin(), apart.end());
    if (i + 1 != kFirstSquares) continue;
    const float error = quantile(all, 0.95);
    if (kClear * error <= limit) return kClear * error;
    if (error > kClear * limit) return error;
  }
  return quantile(all, 0.95);
}

}  // namespace foci
