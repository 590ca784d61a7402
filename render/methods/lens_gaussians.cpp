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
  if (gpu_) {
    return statsOf(gpu_->render(discs, {background, !frame.depth_m.empty()}, frame.gpu));
  }
  RenderStats stats;
  stats.fragments = view_.render(discs, background, frame);
  return stats;
}

RenderStats LensGaussians::render(const ChooseLens& lens_of, const glm::vec3& background,
                                  Frame& frame, std::vector<SampledErrors>* errors) {
  if (!gpu_) {
    RenderStats stats;
    stats.fragments = view_.render(lens_of, background, frame, errors);
    return stats;
  }
  lenses_.clear();
  for (std::size_t t = 0; t < tiles().size(); ++t) lenses_.push_back(lens_of(t));
  return statsOf(gpu_->render(lenses_, {background, !frame.depth_m.empty()}, frame.gpu, errors));
}

const std::vector<Tile>& LensGaussians::tiles() { return gpu_ ? gpu_->tiles() : view_.tiles(); }

const std::vector<TileLayers>& LensGaussians::divide(bool several) {
  return gpu_ ? gpu_->divide(several) : view_.divide(several);
}

}  // namespace foci
