// Depth of field as in today's renderers of Gaussian splats (Kerbl et al., 3D Gaussian Splatting
// for Real-Time Radiance Field Rendering, 2023; the blur as in Spark and in PlayCanvas'
// splat-transform). Prefilter and blur are added to each splat's covariance, V' = V + I + a C^2 I.
// The opacity is scaled by sqrt(det V / det V'), which preserves the splat's light. Splats are
// composited one over the other, front to back. `inflate` has a = 1 / (2 ln 4), from Krivanek, Zara
// and Bouatouch 2003 (Eq. 11). `inflate:spark` has a = 1, and `inflate:splat-transform` a = 4.
// Known failure: splats do not add up to surfaces. A blurred opaque sheet transmits light from the
// surfaces behind it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"
#include "render/kernel/kernel.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/literature/inflate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include <hwy/contrib/math/math-inl.h>

#ifndef FOCI_INFLATE_ONCE
#define FOCI_INFLATE_ONCE
namespace foci {

/// From the reference rasteriser of 3D Gaussian splatting (Kerbl et al. 2023): the largest alpha of
/// a splat at a pixel, and the transmittance at which a pixel counts as opaque. The rasteriser's
/// smallest alpha, 1/255, is left out. It would remove the many small splats of a scan once they
/// are blurred.
inline constexpr float kMaxAlpha = 0.99f, kOpaque = 1e-4f;

/// Every so many splats, a tile checks whether all of its pixels are opaque. Chosen by hand.
inline constexpr int kSplatsBetweenOpaqueChecks = 256;

/// A Gaussian with alpha = peak exp(-q/2).
struct InflatedSplat {
  float x_px, y_px;  // from the tile's corner
  float qa, qb, qc;
  float extent_x_px, extent_y_px;
  float peak;
  float red, green, blue, distance;  // per unit of alpha
};

/// The pixels of a tile, row by row.
struct InflatedTile {
  static constexpr int kTile_px = ViewSplats::kTile_px;
  static constexpr int kPixels = kTile_px * kTile_px;
  alignas(64) float transmittance[kPixels], red[kPixels], green[kPixels], blue[kPixels];
  alignas(64) float distance[kPixels];
};

}  // namespace foci
#endif  // FOCI_INFLATE_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Composites one splat behind the splats that the tile holds. Returns the number of pixels that
/// the splat touched.
std::size_t compositeSplat(const InflatedSplat& splat, InflatedTile& tile) {
  constexpr int kTile_px = InflatedTile::kTile_px;
  const hn::CappedTag<float, 16> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto pixel = [](float px) {
    return static_cast<int>(std::clamp(px, 0.0f, static_cast<float>(kTile_px - 1)));
  };
  const float left = splat.x_px - 0.5f, top = splat.y_px - 0.5f;
  const int x0 = pixel(std::ceil(left - splat.extent_x_px)) / lanes * lanes;
  const int x1 = pixel(left + splat.extent_x_px);
  const int y0 = pixel(std::ceil(top - splat.extent_y_px));
  const int y1 = pixel(top + splat.extent_y_px);
  const auto set = [&](float value) { return hn::Set(d, value); };
  const auto reach = set(kernelShape(kMaxExponent).support2);
  std::size_t met = 0;
  for (int y = y0; y <= y1; ++y) {
    const auto dy = set(static_cast<float>(y) - top);
    for (int x = x0; x <= x1; x += lanes) {
      const auto dx = hn::Sub(hn::Iota(d, static_cast<float>(x)), set(left));
      const auto slope = hn::MulAdd(set(splat.qa), dx, hn::Mul(set(splat.qb), dy));
      const auto q = hn::MulAdd(slope, dx, hn::Mul(hn::Mul(set(splat.qc), dy), dy));
      auto alpha = hn::Mul(set(splat.peak), hn::Exp(d, hn::Mul(set(-0.5f), q)));
      alpha = hn::Min(alpha, set(kMaxAlpha));
      const int at = y * kTile_px + x;
      const auto transmittance = hn::Load(d, tile.transmittance + at);
      const auto counts = hn::And(hn::Lt(q, reach), hn::Gt(transmittance, set(kOpaque)));
      met += hn::CountTrue(d, counts);
      alpha = hn::IfThenElseZero(counts, alpha);
      const auto passed = hn::Mul(transmittance, alpha);
      const auto add = [&](float* sum, float value) {
        hn::Store(hn::MulAdd(passed, set(value), hn::Load(d, sum + at)), d, sum + at);
      };
      add(tile.red, splat.red);
      add(tile.green, splat.green);
      add(tile.blue, splat.blue);
      add(tile.distance, splat.distance);
      hn::Store(hn::Sub(transmittance, passed), d, tile.transmittance + at);
    }
  }
  return met;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(compositeSplat);

namespace {

class InflateMethod final : public Method {
 public:
  InflateMethod(const SurfelCloud& cloud, int variant)
      : gaussians_(cloud), widening_(inflateWidening(variant)) {
    // A Gaussian has no area. With the product of its axes in place of the area, a splat's weights
    // sum to the root of the determinant of its projected covariance.
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      gaussians_.area_m2[i] = glm::length(cloud.axis_u_m[i]) * glm::length(cloud.axis_v_m[i]);
    }
  }

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderSettings widened = settings;
    widened.defocus.radius_px_per_D *= widening_;
    scene_.project(gaussians_, view, widened, {.kernel = BlurKernel::gaussian});
    std::vector<std::uint64_t> fragments(scene_.tileCount());
    parallelFor(fragments.size(),
                [&](std::size_t tile) { fragments[tile] = renderTile(tile, settings, frame); });
    RenderStats stats;
    stats.splats = scene_.count();
    stats.fragments = std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
    return stats;
  }

 private:
  /// The splat's blurred Gaussian, with the opacity that preserves its light.
  static InflatedSplat inflated(const Splat& splat, const glm::vec2& corner_px) {
    // The footprint x' Q x < 1 ends at `support2` squared standard deviations, so V' = Q^-1 /
    // support2. The splat's weights sum to sqrt(det V), see the constructor.
    const float support2 = kernelShape(kMaxExponent).support2;
    const float root_det_q = std::sqrt(splat.qa * splat.qc - 0.25f * splat.qb * splat.qb);
    const float root_det_sharp =
        (splat.k1 / 2.0f + splat.k2 / 3.0f) * std::numbers::pi_v<float> / root_det_q;
    const float root_det_blurred = 1.0f / (support2 * root_det_q);
    const float opacity = std::abs(splat.opacity);
    const float per_opacity = opacity > 0.0f ? 1.0f / opacity : 0.0f;
    return {.x_px = splat.x_px - corner_px.x,
            .y_px = splat.y_px - corner_px.y,
            .qa = support2 * splat.qa,
            .qb = support2 * splat.qb,
            .qc = support2 * splat.qc,
            .extent_x_px = splat.extent_x_px,
            .extent_y_px = splat.extent_y_px,
            .peak = opacity * std::min(1.0f, root_det_sharp / root_det_blurred),
            .red = per_opacity * splat.red,
            .green = per_opacity * splat.green,
            .blue = per_opacity * splat.blue,
            .distance = 0.5f * (splat.near_m + splat.far_m)};
  }

  std::uint64_t renderTile(std::size_t number, const RenderSettings& settings, Frame& frame) const {
    const glm::ivec2 begin = scene_.cornerOf(number);
    const glm::ivec2 size = glm::min(glm::ivec2(InflatedTile::kTile_px), frame.size_px - begin);
    InflatedTile tile{};
    std::fill_n(tile.transmittance, InflatedTile::kPixels, 1.0f);
    std::uint64_t fragments = 0;
    int since_start = 0;
    for (const std::uint32_t index : scene_.splatsOn(number)) {
      if (++since_start % kSplatsBetweenOpaqueChecks == 0 &&
          *std::max_element(tile.transmittance, tile.transmittance + InflatedTile::kPixels) <=
              kOpaque) {
        break;
      }
      const InflatedSplat splat = inflated(scene_.splats()[index], glm::vec2(begin));
      fragments += HWY_DYNAMIC_DISPATCH(compositeSplat)(splat, tile);
    }
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const int i = y * InflatedTile::kTile_px + x;
        const std::size_t p = static_cast<std::size_t>(begin.y + y) * frame.size_px.x + begin.x + x;
        const float covered = 1.0f - tile.transmittance[i];
        frame.rgba[p] = glm::vec4(glm::vec3(tile.red[i], tile.green[i], tile.blue[i]) +
                                      tile.transmittance[i] * settings.lighting.background,
                                  covered);
        if (settings.depth) frame.depth_m[p] = covered > 0.0f ? tile.distance[i] / covered : 0.0f;
      }
    }
    return fragments;
  }

  SurfelCloud gaussians_;
  float widening_;
  ViewSplats scene_;
};

}  // namespace

MethodEntry inflateMethod() {
  return {
      .info = {.name = "inflate",
               .summary =
                   "splats' covariance grown by the blur, opacity scaled down, composited in order",
               .source = "Kerbl et al. 2023; Spark, PlayCanvas",
               .family = MethodFamily::splatting,
               .variants = {"spark", "splat-transform"}},
      .make = makeAs<InflateMethod>,
      .make_of_gaussians = gaussianInflate};
}

}  // namespace foci
#endif  // HWY_ONCE
