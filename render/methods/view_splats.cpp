#include "render/methods/view_splats.h"

#include "base/parallel.h"
#include "render/splat/sweep.h"

namespace foci {

void ViewSplats::project(const SurfelCloud& cloud, const View& view, const RenderSettings& settings,
                         Projection projection, const std::optional<CutSettings>& cut) {
  projection.lighting = settings.lighting;
  size_px_ = view.size_px;
  principal_px_ = view.principal_px;
  defocus_ = settings.defocus;
  if (cut) {
    const std::shared_ptr<const MomentTree> tree = builtTree(cloud);
    selectCut(*tree, view, settings.defocus, *cut, cut_);
    projectCut(*tree, cut_, view, settings.defocus, projection, chunks_);
  } else {
    projectSurfels(cloud, view, settings.defocus, projection, chunks_);
  }
  lists_.build(chunks_, size_px_);
}

void ViewSplats::select(const ViewSplats& all, const std::function<bool(const Splat&)>& belongs) {
  const SplatChunks& from = all.chunks_;
  size_px_ = all.size_px_;
  principal_px_ = all.principal_px_;
  defocus_ = all.defocus_;
  chunks_.chunk_size = from.chunk_size;
  chunks_.count.assign(from.count.size(), 0);
  if (chunks_.capacity < from.capacity) {
    chunks_.splats = makeLargeArray<Splat>(from.capacity);
    chunks_.keys = makeLargeArray<SplatKey>(from.capacity);
    chunks_.capacity = from.capacity;
  }
  parallelFor(from.count.size(), [&](std::size_t c) {
    const std::size_t first = c * from.chunk_size;
    std::uint32_t taken = 0;
    for (std::uint32_t i = 0; i < from.count[c]; ++i) {
      if (!belongs(from.splats[first + i])) continue;
      chunks_.splats[first + taken] = from.splats[first + i];
      chunks_.keys[first + taken] = from.keys[first + i];
      ++taken;
    }
    chunks_.count[c] = taken;
  });
  lists_.build(chunks_, size_px_);
}

std::uint64_t ViewSplats::render(const glm::vec3& background, bool depth, Frame& frame) const {
  frame.resize(size_px_, depth);
  return sweep(chunks_, lists_,
               {.background = background,
                .defocus = defocus_,
                .principal_px = principal_px_,
                .depth = depth},
               frame);
}

std::optional<CutSettings> pixelCutOf(const SurfelCloud& cloud, const Acuity& acuity) {
  if (!builtTree(cloud)) return std::nullopt;
  CutSettings cut = kPixelCut;
  cut.acuity = acuity;
  return cut;
}

PartSplats::PartSplats(const SurfelCloud& cloud, const SharedGpu& gpu) : cloud_(cloud) {
  if (!gpu) return;
  const std::shared_ptr<const MomentTree> tree = builtTree(cloud);
  gpu_ = std::make_unique<GpuSplats>(tree ? std::make_shared<GpuScene>(gpu, *tree)
                                          : std::make_shared<GpuScene>(gpu, cloud));
}

void PartSplats::render(const View& view, RenderSettings settings, const LensPart& part,
                        const Acuity& acuity, Frame& frame, RenderStats& stats) {
  const View seen = viewOfPart(view, part);
  settings.defocus = part.defocus;
  if (gpu_) {
    GpuRequest request = gpuRequestOf(seen, settings);
    request.lens = part.centre;
    request.aperture = part.radius;
    request.acuity = acuity;
    request.cut = pixelCutOf(cloud_, acuity);
    stats.add(statsOf(gpu_->render(request, frame.gpu)));
    return;
  }
  splats_.project(cloud_, seen, settings,
                  {.lens = part.centre, .aperture = part.radius, .acuity = acuity},
                  pixelCutOf(cloud_, acuity));
  stats.splats += splats_.count();
  stats.fragments += splats_.render(settings.lighting.background, settings.depth, frame);
}

GpuRequest gpuRequestOf(const View& view, const RenderSettings& settings) {
  return {.view = view,
          .defocus = settings.defocus,
          .cut = {},
          .acuity = {},
          .lighting = settings.lighting,
          .depth = settings.depth,
          .sub_aperture_centres = {}};
}

RenderStats statsOf(const GpuStats& rendered) {
  RenderStats stats;
  stats.splats = rendered.splats;
  stats.fragments = rendered.fragments;
  stats.gpu = rendered.times;
  return stats;
}

RenderSettings withoutBlur(const RenderSettings& settings) {
  RenderSettings without = settings;
  without.defocus.radius_px_per_D = glm::vec2(0.0f);
  without.pupil = {};
  return without;
}

RenderStats PinholeCamera::render(const View& view, const RenderSettings& settings, Frame& frame) {
  RenderSettings with_depth = withoutBlur(settings);
  with_depth.depth = true;
  return sweep_->render(view, with_depth, frame);
}

}  // namespace foci
