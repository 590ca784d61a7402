#include "render/methods/lens_gaussians.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "render/gl/image.h"
#include "render/image/frame.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/mean_of_parts.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

/// Convolves the linear RGBA of the frame with the discrete Gaussian of this variance,
/// exp(-t) I_n(t) (Lindeberg, Scale-space for discrete signals, PAMI 12(3), 1990). Its variance is
/// exact below a pixel too. The frame continues beyond its border as the border.
/// @param variance_px2  above 0
void spreadLight(Frame& frame, double variance_px2) {
  assert(variance_px2 > 0.0);
  const int reach = 1 + static_cast<int>(std::ceil(5.0 * std::sqrt(variance_px2)));
  std::vector<float> kernel;
  for (int i = 0; i <= reach; ++i) {
    kernel.push_back(
        static_cast<float>(std::exp(-variance_px2) * std::cyl_bessel_i(i, variance_px2)));
  }
  filterSeparably(frame.rgba, frame.size_px, kernel, ImageBorder::replicate);
}

}  // namespace

LensGaussians::LensGaussians(std::shared_ptr<const GaussianCloud> cloud, const SharedGpu& gpu)
    : cloud_(std::move(cloud)), view_(*cloud_) {
  if (gpu) gpu_ = std::make_unique<GpuGaussians>(std::make_shared<GpuGaussianScene>(gpu, *cloud_));
}

LensGaussians LensGaussians::sharingScene() const {
  LensGaussians other(cloud_, nullptr);
  if (gpu_) other.gpu_ = std::make_unique<GpuGaussians>(gpu_->scene());
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

RenderStats GaussianEyeMethod::renderFrame(const View& view, const RenderSettings& settings,
                                           Frame& frame) {
  const RenderStats stats = renderGeometry(view, settings, frame);
  const double sigma_px = diffractionThroughPixel_px(settings.pupil.diffraction_px);
  if (sigma_px > 0.0) {
    readFromGpu(frame);
    spreadLight(frame, sigma_px * sigma_px);
  }
  return stats;
}

RenderStats GaussianParts::render(LensGaussians& scene, const std::vector<LensPart>& parts,
                                  const View& view, const RenderSettings& settings,
                                  const GaussianCutSettings* lod, Frame& frame) {
  const float share = partDiscRadius(parts.size());
  RenderStats stats;
  meanOfParts(parts, 0.0f, part_, frame, [&](const LensPart& part, Frame& to) {
    const std::vector<LensDisc> disc = {{part.centre, share * part.radius}};
    stats.add(scene.project(viewOfPart(view, part), part.defocus, disc, lod));
    stats.add(scene.render(disc, settings.lighting.background, to));
  });
  return stats;
}

}  // namespace foci
