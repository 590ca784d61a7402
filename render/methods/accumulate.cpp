// The reference: the average of N pinhole views from points all over the lens, with the focus kept
// (Haeberli and Akeley, The Accumulation Buffer: Hardware Support for High-Quality Rendering,
// SIGGRAPH 1990). Known failure: a blur radius of C pixels needs about pi C^2 views; fewer views
// show as ghosts. The frame's own split-half error tells how far it can be trusted.

#include "base/parallel.h"
#include "render/gl/image.h"
#include "render/image/metrics.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class AccumulateMethod final : public Method {
 public:
  AccumulateMethod(const SurfelCloud& cloud, int views, const SharedGpu& gpu)
      : scene_(cloud, gpu), views_(views) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const std::size_t pixels = static_cast<std::size_t>(view.size_px.x) * view.size_px.y;
    const auto width = static_cast<std::size_t>(view.size_px.x);
    for (Frame* one : {&frame, &odd_, &view_}) {
      one->size_px = view.size_px;
      one->rgba.assign(pixels, glm::vec4(0.0f));
      one->depth_m.assign(settings.depth ? pixels : 0, 0.0f);
    }

    // Sum even views in `frame` and odd views in `odd_`, to compare the two halves.
    RenderStats stats;
    const std::vector<LensPart> parts =
        lensPoints(settings.defocus, settings.pupil, lensSamples(views_));
    for (int i = 0; i < views_; ++i) {
      const LensPart& part = parts[static_cast<std::size_t>(i)];
      scene_.render(view, settings, part, widened({}, settings.pupil), view_, stats);
      readFromGpu(view_);
      const float weight = part.weight * static_cast<float>(views_);
      Frame& half = i % 2 == 0 ? frame : odd_;
      parallelFor(static_cast<std::size_t>(view.size_px.y), [&](std::size_t y) {
        for (std::size_t p = y * width; p < (y + 1) * width; ++p) {
          half.rgba[p] += weight * view_.rgba[p];
          if (settings.depth) half.depth_m[p] += weight * view_.depth_m[p] * view_.rgba[p].a;
        }
      });
    }

    const float even = 1.0f / static_cast<float>((views_ + 1) / 2);
    const float odd = 1.0f / static_cast<float>(std::max(1, views_ / 2));
    const float all = 1.0f / static_cast<float>(views_);
    for (std::size_t p = 0; p < pixels; ++p) {
      const glm::vec4 sum = frame.rgba[p] + odd_.rgba[p];
      const float coverage = sum.a;
      frame.rgba[p] *= even;
      odd_.rgba[p] *= odd;
      view_.rgba[p] = sum * all;
      if (settings.depth && coverage > 0.0f) {
        frame.depth_m[p] = (frame.depth_m[p] + odd_.depth_m[p]) / coverage;
      }
    }
    // The halves differ by twice the noise of their mean.
    if (views_ > 1) stats.split_half_psnr_dB = psnr_dB(frame, odd_);
    std::swap(frame.rgba, view_.rgba);
    return stats;
  }

 private:
  PartSplats scene_;
  int views_;
  Frame odd_, view_;
};

}  // namespace

MethodEntry accumulateMethod() {
  return {.info = {.name = "accumulate",
                   .summary = "N pinhole views over the lens, averaged: the reference",
                   .source = "Haeberli and Akeley 1990",
                   .family = MethodFamily::many_views,
                   .max_n = 100000,
                   .default_n = 200,
                   .aberrations = true,
                   .gpu = true,
                   .lod = true},
          .make = makeAs<AccumulateMethod>,
          .make_of_gaussians = gaussianAccumulate};
}

}  // namespace foci
