#include "render/methods/lens_gaussians.h"

#include <cassert>
#include <utility>

#include "render/methods/view_splats.h"

namespace foci {

LensGaussians::LensGaussians(std::shared_ptr<const GaussianCloud> cloud, const SharedGpu& gpu)
    : cloud_(std::move(cloud)), view_(*cloud_) {
  if (gpu) gpu_.emplace(std::make_shared<GpuGaussianScene>(gpu, *cloud_));
}

LensGaussians::LensGaussians(const LensGaussians& other, std::nullptr_t)
    : cloud_(other.cloud_), view_(*cloud_) {
  if (other.gpu_) gpu_.emplace(other.gpu_->scene());
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

GaussianView& LensGaussians::onCpu() {
  assert(!isOnGpu());
  return view_;
}

}  // namespace foci
