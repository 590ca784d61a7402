#include "render/methods/spot_check.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

/// Chosen for the accuracy that spot_check.h states.
constexpr int kSquare_px = kTile, kSquares = 48, kFirstSquares = 16;

/// The estimate of the first squares may be wrong by this factor either way.
constexpr float kFactorOfFirst = 2.0f;

/// Corners of `count` different tiles inside the image, spread evenly by the R2 sequence (Roberts,
/// The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
std::vector<glm::ivec2> cornersIn(const glm::ivec2& tiles, std::size_t count) {
  std::vector<glm::ivec2> corners;
  for (int k = 0; corners.size() < count; ++k) {
    const glm::dvec2 at =
        glm::fract(0.5 + static_cast<double>(k) * glm::dvec2(0.7548776662, 0.5698402910));
    const glm::ivec2 corner = kSquare_px * glm::ivec2(at * glm::dvec2(tiles));
    if (std::ranges::find(corners, corner) == corners.end()) corners.push_back(corner);
  }
  return corners;
}

Frame copyOf(const Window& window, const Frame& frame) {
  Frame copy;
  copy.resize(window.size_px);
  for (int y = 0; y < window.size_px.y; ++y) {
    const auto row = static_cast<std::ptrdiff_t>(window.corner_px.y + y) * frame.size_px.x;
    std::copy_n(frame.rgba.begin() + row + window.corner_px.x, window.size_px.x,
                copy.rgba.begin() + static_cast<std::ptrdiff_t>(y) * window.size_px.x);
  }
  return copy;
}

}  // namespace

SpotCheck::SpotCheck(LodSplats& scene, const View& view, const RenderSettings& settings,
                     const LodSettings& reference, Frame& frame)
    : scene_(scene), view_(view), settings_(settings), reference_(reference), frame_(frame) {
  const glm::ivec2 tiles = view.size_px / kSquare_px;
  if (tiles.x * tiles.y < 2 * kSquares) {
    squares_.push_back({glm::ivec2(0), view.size_px});
    return;
  }
  for (const glm::ivec2& corner_px : cornersIn(tiles, kSquares)) {
    squares_.push_back({corner_px, glm::ivec2(kSquare_px)});
  }
}

std::unique_ptr<LodSplats> SpotCheck::idleSplats() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<LodSplats>(scene_, nullptr);
  auto last = std::move(idle_.back());
  idle_.pop_back();
  return last;
}

Frame SpotCheck::render(const Window& square, const LodSettings& lod) {
  View view = view_;
  view.size_px = square.size_px;
  view.principal_px -= glm::vec2(square.corner_px);
  LodSettings moved = lod;
  moved.cut.acuity.gaze_px -= glm::vec2(square.corner_px);
  RenderSettings settings = settings_;
  settings.depth = false;
  Frame frame;
  frame.resize(view.size_px);
  auto splats = idleSplats();
  splats->render(view, settings, moved, frame);
  readFromGpu(frame);
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(splats));
  return frame;
}

std::vector<Frame> SpotCheck::render(std::size_t begin, std::size_t end, const LodSettings& lod) {
  std::vector<Frame> frames(end - begin);
  const auto renderOne = [&](std::size_t i) { frames[i] = render(squares_[begin + i], lod); };
  if (scene_.isOnGpu()) {  // it renders one square at a time
    for (std::size_t i = 0; i < frames.size(); ++i) renderOne(i);
  } else {
    parallelFor(frames.size(), renderOne);
  }
  return frames;
}

std::vector<float> SpotCheck::differences(std::size_t begin, std::size_t end,
                                          const LodSettings& lod) {
  if (references_.size() < end) {
    std::ranges::move(render(references_.size(), end, reference_), std::back_inserter(references_));
  }
  std::vector<Frame> squares;
  const std::span<const Window> windows(squares_.begin() + begin, squares_.begin() + end);
  if (scene_.renderWindows(view_, settings_, lod, windows, frame_)) {
    for (const Window& window : windows) squares.push_back(copyOf(window, frame_));
  } else {
    squares = render(begin, end, lod);
  }
  std::vector<std::vector<float>> apart(end - begin);
  parallelFor(apart.size(), [&](std::size_t i) {
    apart[i] = visibleDifference(squares[i], references_[begin + i], kUsualPx_per_deg);
  });
  std::vector<float> all;
  for (const auto& each : apart) all.insert(all.end(), each.begin(), each.end());
  return all;
}

float SpotCheck::error(const LodSettings& lod, float limit) {
  const std::size_t first = std::min<std::size_t>(kFirstSquares, squares_.size());
  std::vector<float> all = differences(0, first, lod);
  if (first == squares_.size()) return quantile(all, 0.95);
  const float error = quantile(all, 0.95);
  if (kFactorOfFirst * error <= limit) return kFactorOfFirst * error;
  if (error > kFactorOfFirst * limit) return error;
  const std::vector<float> rest = differences(first, squares_.size(), lod);
  all.insert(all.end(), rest.begin(), rest.end());
  return quantile(all, 0.95);
}

}  // namespace foci
