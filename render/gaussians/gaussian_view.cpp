#include "render/gaussians/gaussian_view.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/parallel.h"
#include "render/image/srgb.h"
#include "render/splat/interpolate.h"

namespace foci {

void GaussianView::project(const View& view, const Defocus& defocus,
                           const std::vector<LensDisc>& discs, const GaussianCutSettings* lod) {
  defocus_ = defocus;
  std::vector<SubApertureSize> sizes;
  for (const LensDisc& disc : discs) {
    const SubApertureSize each{glm::length(disc.centre), disc.radius};
    // Of discs of one size, the farthest from the middle bounds the others.
    if (sizes.empty() || sizes.back().aperture != each.aperture) {
      sizes.push_back(each);
    } else {
      sizes.back().max_radius = std::max(sizes.back().max_radius, each.max_radius);
    }
  }
  if (lod) selectCut(*cloud_, view, defocus, *lod, cut_);
  projectGaussians(*cloud_, lod ? &cut_ : nullptr, view, defocus, sizes, projected_);
  lists_.build(projected_.chunks, view.size_px, lod != nullptr);
}

TileBlur GaussianView::tileBlur(std::size_t tile) const {
  double sum = 0.0, weights = 0.0;
  for (const std::uint32_t index : lists_.splats(tile)) {
    const double blur2 = double{projected_.chunks.keys[index].blur_px} *
                         double{projected_.chunks.keys[index].blur_px};
    const double peak = std::min(projected_.gaussians[index].opacity, 1.0f);
    sum += peak * blur2 * blur2;
    weights += peak;
  }
  return {
      .radius_px = weights > 0.0 ? static_cast<float>(std::sqrt(std::sqrt(sum / weights))) : 0.0f,
      .everywhere = lists_.tiles()[tile].step_px > 1};
}

std::vector<TileBlur> GaussianView::tileBlurs() const {
  std::vector<TileBlur> blurs(lists_.tiles().size());
  parallelFor(blurs.size(), [&](std::size_t t) { blurs[t] = tileBlur(t); });
  return blurs;
}

std::uint64_t GaussianView::render(const std::vector<LensDisc>& discs, const glm::vec3& background,
                                   Frame& frame) {
  return renderTiles([&](std::size_t) { return &discs; }, background, frame, nullptr);
}

std::uint64_t GaussianView::render(const ChooseDiscs& discs_of, const glm::vec3& background,
                                   Frame& frame, std::vector<SampledErrors>& errors) {
  errors.resize(lists_.tiles().size());
  return renderTiles(discs_of, background, frame, &errors);
}

std::uint64_t GaussianView::renderTiles(const ChooseDiscs& discs_of, const glm::vec3& background,
                                        Frame& frame, std::vector<SampledErrors>* errors) {
  const bool depth = !frame.depth_m.empty();
  const glm::vec3 shown(srgbFromLinear(background.r), srgbFromLinear(background.g),
                        srgbFromLinear(background.b));
  const std::vector<Tile>& tiles = lists_.tiles();
  std::vector<std::uint64_t> fragments(tiles.size());
  parallelFor(tiles.size(), [&](std::size_t t) {
    const std::vector<LensDisc>* const discs = discs_of(t);
    if (!discs) return;
    const Tile& tile = tiles[t];
    thread_local const auto sums = std::make_unique<TileSums>();
    const int samples = tile.samplesWithApron();
    const std::size_t row = rowOf(samples);
    for (float* plane : {sums->red, sums->green, sums->blue, sums->coverage, sums->distance_m}) {
      std::fill_n(plane, row * static_cast<std::size_t>(samples), 0.0f);
    }
    const auto step_px = static_cast<float>(tile.step_px);
    const glm::vec2 first_px =
        glm::vec2(tile.x_px, tile.y_px) + step_px * (0.5f - static_cast<float>(tile.apron()));
    thread_local TileGaussians gaussians;
    gaussians.begin(projected_.gaussians.data(), lists_.splats(t));
    thread_local ViewSpread spread;
    if (errors) spread.begin(samples, tile.apron());
    for (const LensDisc& disc : *discs) {
      fragments[t] += compositeTile({.gaussians = &gaussians,
                                     .defocus = &defocus_,
                                     .first_px = first_px,
                                     .step_px = step_px,
                                     .samples = samples,
                                     .lens = disc,
                                     .background = shown,
                                     .depth = depth},
                                    *sums);
      if (errors) spread.add(*sums);
    }
    if (errors && discs->size() > 1) (*errors)[t] = spread.standardErrors();
    const float weight = 1.0f / static_cast<float>(discs->size());
    constexpr std::size_t kMaxSamples = kTile + 2 * kApron;
    glm::vec4 rgba[kMaxSamples * kMaxSamples];
    float depth_m[kMaxSamples * kMaxSamples];
    for (int y = 0; y < samples; ++y) {
      for (int x = 0; x < samples; ++x) {
        const std::size_t from = static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x);
        const int to = y * samples + x;
        rgba[to] = weight * glm::vec4(sums->red[from], sums->green[from], sums->blue[from],
                                      sums->coverage[from]);
        depth_m[to] = weight * sums->distance_m[from];
      }
    }
    interpolateTile(tile, rgba, depth ? depth_m : nullptr, frame);
  });
  return std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
}

}  // namespace foci
