#include "render/gaussians/gaussian_view.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "base/parallel.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// Linear light as the compositor computes it, so that tiles with and without Gaussians agree.
glm::vec3 lightOfDisplay(const glm::vec3& shown) {
  TileGaussians none;
  none.begin(nullptr, {});
  const CompositeJob job{.gaussians = &none,
                         .defocus = nullptr,
                         .principal_px = {},
                         .first_px = {},
                         .samples = 1,
                         .lens = {},
                         .background = shown,
                         .behind = nullptr};
  const auto sums = std::make_unique<TileSums>();
  compositeTile(job, *sums, {}, {});
  return {sums->red[0], sums->green[0], sums->blue[0]};
}

/// A tile without Gaussians.
void fillTile(const Tile& tile, const glm::vec3& light, Frame& frame) {
  const glm::ivec2 end_px =
      glm::min(glm::ivec2(tile.x_px, tile.y_px) + tile.side_px, frame.size_px);
  for (int y = tile.y_px; y < end_px.y; ++y) {
    const auto row = static_cast<std::ptrdiff_t>(y) * frame.size_px.x + tile.x_px;
    std::fill_n(frame.rgba.begin() + row, end_px.x - tile.x_px, glm::vec4(light, 0.0f));
    if (!frame.depth_m.empty()) {
      std::fill_n(frame.depth_m.begin() + row, end_px.x - tile.x_px, 0.0f);
    }
  }
}

SampledErrors noErrors(const Tile& tile) {
  const auto along =
      static_cast<std::size_t>(followedAlong(tile.samplesWithApron(), tile.apron()).count);
  return {.layers_jnd = {}, .count = along * along};
}

}  // namespace

void GaussianView::project(const View& view, const Defocus& defocus,
                           const std::vector<LensDisc>& discs, const GaussianCutSettings* lod) {
  defocus_ = defocus;
  size_px_ = view.size_px;
  principal_px_ = view.principal_px;
  layers_.clear();
  if (lod) selectCut(*cloud_, view, defocus, *lod, cut_);
  projectGaussians(*cloud_, lod ? &cut_ : nullptr, view, defocus, subApertureSizes(discs),
                   projected_);
  lists_.build(projected_.chunks, view.size_px, lod != nullptr);
}

const std::vector<TileLayers>& GaussianView::divide(bool several) {
  layers_.resize(tiles().size());
  parallelFor(layers_.size(), [&](std::size_t t) {
    const Tile& tile = tiles()[t];
    const std::span<const std::uint32_t> list = lists_.splats(t);
    if (several && tile.step_px == 1) {
      layers_[t] = layersOf(tile, list, projected_, size_px_);
    } else {
      layers_[t] = oneLayer(tile, list.size());
      layers_[t].layers[0].blur = blurOf(tile, list, projected_);
    }
  });
  return layers_;
}

std::uint64_t GaussianView::render(const std::vector<LensDisc>& discs, const glm::vec3& background,
                                   Frame& frame) {
  return render([&](std::size_t) { return TileLens{.discs = &discs}; }, background, frame);
}

std::uint64_t GaussianView::render(const ChooseLens& lens_of, const glm::vec3& background,
                                   Frame& frame, std::vector<SampledErrors>* errors) {
  if (errors) errors->resize(tiles().size());
  const glm::vec3 shown(srgbFromLinear(background.r), srgbFromLinear(background.g),
                        srgbFromLinear(background.b));
  const glm::vec3 light = lightOfDisplay(shown);
  std::vector<std::uint64_t> fragments(tiles().size());
  parallelFor(tiles().size(), [&](std::size_t t) {
    const TileLens lens = lens_of(t);
    if (!lens.discs) return;
    const Tile& tile = tiles()[t];
    const std::span<const std::uint32_t> list = lists_.splats(t);
    if (list.empty() && lens.weight == 1.0f) {
      fillTile(tile, light, frame);
      if (errors) (*errors)[t] = noErrors(tile);
      return;
    }
    const int samples = tile.samplesWithApron();
    thread_local const auto sums = std::make_unique<TileSums>();
    for (float* plane : {sums->red, sums->green, sums->blue, sums->coverage, sums->distance_m}) {
      std::fill_n(plane, placesOf(samples), 0.0f);
    }
    const auto step_px = static_cast<float>(tile.step_px);
    const auto apron = static_cast<float>(tile.apron());
    const CompositeJob job{.gaussians = nullptr,
                           .defocus = &defocus_,
                           .principal_px = principal_px_,
                           .first_px = glm::vec2(tile.x_px, tile.y_px) + step_px * (0.5f - apron),
                           .step_px = step_px,
                           .samples = samples,
                           .lens = {},
                           .background = shown,
                           .behind = nullptr,
                           .depth = !frame.depth_m.empty()};
    thread_local LayerStack stack;
    fragments[t] = stack.render(projected_.gaussians.data(), list,
                                layers_.empty() ? oneLayer(tile, list.size()) : layers_[t],
                                tile.apron(), lens, job, *sums, errors ? &(*errors)[t] : nullptr);
    writeTile(tile, *sums, lens, frame);
  });
  return std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
}

void GaussianView::writeTile(const Tile& tile, const TileSums& sums, const TileLens& lens,
                             Frame& frame) {
  const float share = 1.0f / static_cast<float>(lens.discs->size());
  const int samples = tile.samplesWithApron();
  glm::vec4 rgba[kMostSamples * kMostSamples];
  float depth_m[kMostSamples * kMostSamples];
  for (int y = 0; y < samples; ++y) {
    for (int x = 0; x < samples; ++x) {
      const std::size_t from =
          placeOf(samples, static_cast<std::size_t>(x), static_cast<std::size_t>(y));
      const int to = y * samples + x;
      rgba[to] =
          share * glm::vec4(sums.red[from], sums.green[from], sums.blue[from], sums.coverage[from]);
      depth_m[to] = share * sums.distance_m[from];
    }
  }
  interpolateTile(tile, rgba, frame.depth_m.empty() ? nullptr : depth_m, lens.weight, frame);
}

}  // namespace foci
