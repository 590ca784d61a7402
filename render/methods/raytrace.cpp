// The other reference: N rays a pixel through points all over the lens, against the surfels' discs,
// with the focus kept (Cook, Porter and Carpenter, Distributed Ray Tracing, SIGGRAPH 1984; the rays
// by Embree). It estimates the same image as `accumulate:N`, with the same kernels and layers, but
// each pixel has lens points of its own. So it errs by noise where `accumulate` shows ghosts. Known
// failure: the noise falls only with the root of N, and time grows with N. The frame's own
// split-half error tells how far it can be trusted.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "render/image/metrics.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/methods/random_bits.h"
#include "render/methods/raytrace/disc_scene.h"
#include "render/methods/raytrace/ray_layers.h"
#include "render/methods/raytrace/seen_surfel.h"

namespace foci {
namespace {

/// Two random numbers of a pixel, 0 to 1.
glm::vec2 randomOf(std::uint64_t pixel) {
  const std::uint64_t bits = randomBits(pixel);
  return {static_cast<float>(bits >> 40) * 0x1p-24f,
          static_cast<float>(bits & 0xffffffu) * 0x1p-24f};
}

class RaytraceMethod final : public Method {
 public:
  RaytraceMethod(const SurfelCloud& cloud, int rays) : cloud_(cloud), rays_(rays) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const auto width = static_cast<std::size_t>(view.size_px.x);
    const auto height = static_cast<std::size_t>(view.size_px.y);
    for (Frame* one : {&frame, &even_, &odd_}) {
      one->size_px = view.size_px;
      one->rgba.resize(width * height);
    }
    frame.depth_m.assign(settings.depth ? width * height : 0, 0.0f);

    const std::vector<SeenSurfel> surfels =
        seenSurfels(cloud_, view, settings.defocus.along, settings.shading);
    const DiscScene scene(surfels, settings.defocus);
    // Through a pinhole all rays of a pixel are one.
    const int rays = settings.defocus.radius_px_per_D == glm::vec2(0.0f) ? 1 : rays_;
    std::vector<std::uint64_t> fragments(height);
    parallelFor(height, [&](std::size_t y) {
      fragments[y] = renderRow(y, rays, surfels, scene, settings, frame);
    });

    RenderStats stats;
    stats.splats = surfels.size();
    for (const std::uint64_t row : fragments) stats.fragments += row;
    if (rays > 1) {
      stats.split_half_psnr_dB = psnr_dB(even_, odd_);
    } else if (rays_ > 1) {
      stats.split_half_psnr_dB = std::numeric_limits<double>::infinity();
    }
    return stats;
  }

 private:
  /// @return the number of fragments
  std::uint64_t renderRow(std::size_t y, int rays, const std::vector<SeenSurfel>& surfels,
                          const DiscScene& scene, const RenderSettings& settings, Frame& frame) {
    const auto width = static_cast<std::size_t>(frame.size_px.x);
    std::uint64_t fragments = 0;
    std::vector<Hit> hits;
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t p = y * width + x;
      const glm::vec2 random = randomOf(p);
      glm::vec4 halves[2] = {glm::vec4(0.0f), glm::vec4(0.0f)};  // of the even and the odd rays
      float distance = 0.0f;
      for (int i = 0; i < rays; ++i) {
        scene.trace({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f},
                    lensSampleOfPixel(i, rays, random.x, random.y), hits);
        fragments += hits.size();
        const RayColor seen = composite(surfels, !cloud_.opacity.empty(), hits);
        halves[i % 2] += glm::vec4(seen.color + seen.transmittance * settings.background,
                                   1.0f - seen.transmittance);
        distance += seen.distance;
      }
      const glm::vec4 sum = halves[0] + halves[1];
      frame.rgba[p] = sum / static_cast<float>(rays);
      if (settings.depth && sum.a > 0.0f) frame.depth_m[p] = distance / sum.a;
      even_.rgba[p] = halves[0] / static_cast<float>((rays + 1) / 2);
      odd_.rgba[p] = halves[1] / static_cast<float>(std::max(1, rays / 2));
    }
    return fragments;
  }

  const SurfelCloud& cloud_;
  int rays_;
  Frame even_, odd_;
};

}  // namespace

MethodEntry raytraceMethod() {
  return {.info = {.name = "raytrace",
                   .summary = "N rays a pixel through the lens, against discs: the other reference",
                   .source = "Cook, Porter and Carpenter 1984",
                   .max_n = 100000,
                   .default_n = 64},
          .make = makeAs<RaytraceMethod>};
}

}  // namespace foci
