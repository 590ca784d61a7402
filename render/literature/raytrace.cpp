// A reference: N rays a pixel through points all over the lens, with the focus kept (Cook, Porter
// and Carpenter, Distributed Ray Tracing, SIGGRAPH 1984; the rays by Embree).
//
// A scene that was sampled from a mesh is traced as the mesh: its triangles, textures and
// materials. So this reference does not share the surfels' faults. Each ray meets the image at its
// own point, by the filter that the splats have (a variance of one square pixel, kernel.h).
//
// Other scenes are traced as the surfels' discs, with the kernels and layers of `accumulate:N`.
// Each pixel has lens points of its own, so it errs by noise where `accumulate` shows ghosts.
//
// Known failure: the noise falls only with the root of N, and time grows with N. The frame's own
// split-half error tells how far it can be trusted.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/random_bits.h"
#include "render/image/metrics.h"
#include "render/literature/raytrace/disc_scene.h"
#include "render/literature/raytrace/ray_layers.h"
#include "render/literature/raytrace/triangle_scene.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"

namespace foci {
namespace {

/// Two random numbers of a pixel, 0 to 1.
glm::vec2 randomOf(std::uint64_t pixel) {
  const std::uint64_t bits = randomBits(pixel);
  return {static_cast<float>(bits >> 40) * 0x1p-24f,
          static_cast<float>(bits & 0xffffffu) * 0x1p-24f};
}

/// Ray `i` of a pixel: its offset on the image, distributed as the kernel of a sharp point,
/// (1 - |x|^2 / s^2)^2 with s^2 = kWidestSupport2. The additive recurrence R2 (Roberts 2018)
/// spreads the offsets of a pixel.
glm::vec2 filterOffset(int i, const glm::vec2& random) {
  const double radial = std::fmod(random.x + 0.7548776662466927 * i, 1.0);
  const double turn = std::fmod(random.y + 0.5698402909980532 * i, 1.0);
  const double radius = std::sqrt(kWidestSupport2 * (1.0 - std::cbrt(1.0 - radial)));
  const double angle_rad = glm::two_pi<double>() * turn;
  return {static_cast<float>(radius * std::cos(angle_rad)),
          static_cast<float>(radius * std::sin(angle_rad))};
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

    return cloud_.mesh ? renderTriangles(view, settings, frame)
                       : renderDiscs(view, settings, frame);
  }

 private:
  RenderStats renderTriangles(const View& view, const RenderSettings& settings, Frame& frame) {
    const TriangleScene scene(*cloud_.mesh, view, settings.defocus, settings.lighting);
    const auto see = [&](const glm::vec2& center_px, std::uint64_t pixel, int i,
                         std::uint64_t& fragments) {
      const glm::vec2 random = randomOf(2 * pixel);
      const glm::vec2 at_px = center_px + filterOffset(i, randomOf(2 * pixel + 1));
      return scene.trace(at_px, lensSampleOfPixel(i, rays_, random.x, random.y), fragments);
    };
    RenderStats stats = renderRows(rays_, settings, frame, see);
    stats.splats = scene.size();
    return stats;
  }

  RenderStats renderDiscs(const View& view, const RenderSettings& settings, Frame& frame) {
    const std::vector<SeenSurfel> surfels =
        seenSurfels(cloud_, view, settings.defocus.along, settings.lighting);
    const DiscScene scene(surfels, settings.defocus);
    // Through a pinhole all rays of a pixel are one.
    const bool pinhole = settings.defocus.radius_px_per_D == glm::vec2(0.0f);
    const int rays = pinhole ? 1 : rays_;
    const auto see = [&](const glm::vec2& center_px, std::uint64_t pixel, int i,
                         std::uint64_t& fragments) {
      static thread_local std::vector<Hit> hits;
      const glm::vec2 random = randomOf(pixel);
      scene.trace(center_px, lensSampleOfPixel(i, rays, random.x, random.y), hits);
      fragments += hits.size();
      return composite(surfels, !cloud_.opacity.empty(), hits);
    };
    RenderStats stats = renderRows(rays, settings, frame, see);
    stats.splats = surfels.size();
    if (pinhole && rays_ > 1) {
      stats.split_half_psnr_dB = std::numeric_limits<double>::infinity();
    }
    return stats;
  }

  /// @param see  (pixel centre, number of the pixel, number of the ray, fragments) -> RayColor
  template <class See>
  RenderStats renderRows(int rays, const RenderSettings& settings, Frame& frame, const See& see) {
    const auto width = static_cast<std::size_t>(frame.size_px.x);
    const auto height = static_cast<std::size_t>(frame.size_px.y);
    std::vector<std::uint64_t> fragments(height, 0);
    parallelFor(height, [&](std::size_t y) {
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = y * width + x;
        const glm::vec2 center_px(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        glm::vec4 halves[2] = {glm::vec4(0.0f), glm::vec4(0.0f)};  // of the even and the odd rays
        float distance = 0.0f;
        for (int i = 0; i < rays; ++i) {
          const RayColor seen = see(center_px, p, i, fragments[y]);
          halves[i % 2] += glm::vec4(seen.color + seen.transmittance * settings.lighting.background,
                                     1.0f - seen.transmittance);
          distance += seen.distance;
        }
        const glm::vec4 sum = halves[0] + halves[1];
        frame.rgba[p] = sum / static_cast<float>(rays);
        if (settings.depth && sum.a > 0.0f) frame.depth_m[p] = distance / sum.a;
        even_.rgba[p] = halves[0] / static_cast<float>((rays + 1) / 2);
        odd_.rgba[p] = halves[1] / static_cast<float>(std::max(1, rays / 2));
      }
    });
    RenderStats stats;
    for (const std::uint64_t row : fragments) stats.fragments += row;
    if (rays > 1) stats.split_half_psnr_dB = psnr_dB(even_, odd_);
    return stats;
  }

  const SurfelCloud& cloud_;
  int rays_;
  Frame even_, odd_;
};

}  // namespace

MethodEntry raytraceMethod() {
  return {.info = {.name = "raytrace",
                   .summary =
                       "N rays a pixel through the lens, against triangles or discs: a reference",
                   .source = "Cook, Porter and Carpenter 1984",
                   .family = MethodFamily::many_views,
                   .max_n = 100000,
                   .default_n = 64},
          .make = makeAs<RaytraceMethod>};
}

}  // namespace foci
