#include "render/methods/lens_gaussians.h"

#include <utility>

#include "render/methods/view_splats.h"

namespace foci {

LensGaussians::LensGaussians(std::shared_ptr<const GaussianCloud> cloud, const SharedGpu& gpu)
    : cloud_(std::move(cloud)), view_(*cloud_) {
  if (gpu) gpu_.emplace(std::make_shared<GpuGaussianScene>(gpu, *cloud_));
}

LensGaussians LensGaussians::sharingScene() const {
  LensGaussians other(cloud_, nullptr);
  if (gpu_) other.gpu_.emplace(gpu_->scene());
  return other;
}

RenderStats LensGaussians::project(const View& view, const Defocus& defocus,
                                   const std::vector<LensDisc>& discs,
                                   const GaussianCutSettings* lod) {
  if (gpu_) return statsOf(gpu_->project(view, defocus, subApertureSizes(discs), lod));
  view_.project(view, defocus, discs, lod);
  RenderStats stats;
  stats.splats = view_.count();
  return stats;
}

RenderStats LensGaussians::render(const std::vector<LensDisc>& discs, const glm::vec3& background,
                                  Frame& frame) {
  if (gpu_) return statsOf(gpu_->render(discs, background, !frame.depth_m.empty(), frame.gpu));
  RenderStats stats;
  stats.fragments = view_.render(discs, background, frame);
  return stats;
}

std::uint32_t LensGaussians::firstOf(const std::vector<LensDisc>& discs) {
  std::size_t first = 0;
  for (const std::vector<LensDisc>* each : sets_) {
    if (each == &discs) return static_cast<std::uint32_t>(first);
    first += each->size();
  }
  sets_.push_back(&discs);
  discs_.insert(discs_.end(), discs.begin(), discs.end());
  return static_cast<std::uint32_t>(first);
}

RenderStats LensGaussians::render(const ChooseLens& lens_of, const glm::vec3& background,
                                  Frame& frame, std::vector<SampledErrors>* errors) {
  if (!gpu_) {
    RenderStats stats;
    stats.fragments = view_.render(lens_of, background, frame, errors);
    return stats;
  }
  sets_.clear();
  discs_.clear();
  of_tiles_.assign(tiles().size(), {});
  for (std::size_t t = 0; t < of_tiles_.size(); ++t) {
    const TileLens lens = lens_of(t);
    if (!lens.discs) continue;
    of_tiles_[t] = {.first = firstOf(*lens.discs),
                    .count = static_cast<std::uint32_t>(lens.discs->size()),
                    .weight = lens.weight};
  }
  return statsOf(
      gpu_->render(discs_, of_tiles_, background, !frame.depth_m.empty(), frame.gpu, errors));
}

const std::vector<Tile>& LensGaussians::tiles() {
  return gpu_ ? gpu_->tiles().tiles : view_.tiles();
}

const std::vector<TileLayers>& LensGaussians::divide(bool several) {
  return gpu_ ? gpu_->tiles().layers : view_.divide(several);
}

}  // namespace foci
