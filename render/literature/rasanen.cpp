// Stochastic surface splatting (Rasanen, Surface Splatting: Theory, Extensions and Implementation,
// Master's thesis, Helsinki University of Technology, 2002, as Krivanek, Zara and Bouatouch 2003
// describe it). Each splat's blurred resampling kernel is sampled at N random places. Each sample
// is a fragment with 1/N of the splat's weight. Fragments join to surfaces by their depth ranges
// and are composited as in an A-buffer. Blurred surfaces stay surfaces, so nothing leaks
// systematically. Known failure: noise, which falls only with the root of N. Random holes in a
// surface show the surfaces behind it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "base/parallel.h"
#include "base/random_bits.h"
#include "render/kernel/kernel.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

constexpr int kTile_px = ViewSplats::kTile_px;

/// Every so many splats, a tile checks whether all of its pixels are opaque. Chosen by hand.
constexpr int kSplatsBetweenChecks = 1024;

/// Unit vectors of evenly spaced directions.
std::array<glm::vec2, 4096> directionTable() {
  std::array<glm::vec2, 4096> table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double angle_rad =
        2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(table.size());
    table[i] = glm::vec2(std::cos(angle_rad), std::sin(angle_rad));
  }
  return table;
}

/// Samples places from a splat's kernel over the ellipse q < 1: its plateau, and k1 t and k2 t^2.
class KernelSampler {
 public:
  explicit KernelSampler(const Splat& splat) : center_px_(splat.x_px, splat.y_px) {
    // q = |L' x|^2 with L lower triangular, so L'^-1 maps the unit disc to the ellipse.
    l11_ = std::sqrt(splat.qa);
    l21_ = 0.5f * splat.qb / l11_;
    l22_ = std::sqrt(std::max(splat.qc - l21_ * l21_, 0.0f));
    rim_ = std::min(splat.k0 / splat.k1, 1.0f);
    const float flat = splat.k0 * (1.0f - rim_), cone = splat.k1 * rim_ * rim_ / 2.0f;
    const float bell = splat.k2 / 3.0f;
    const float sum = flat + cone + bell;
    flat_ = flat / sum;
    not_bell_ = (flat + cone) / sum;
    mass_ = sum * std::numbers::pi_v<float> / (l11_ * l22_);
  }

  /// The sum of the splat's weights over all pixels.
  float mass() const { return mass_; }

  glm::vec2 place_px(std::uint64_t bits) const {
    static const auto directions = directionTable();
    constexpr float kUnit = 1.0f / 16777216.0f;
    const float which = static_cast<float>(bits & 0xffffff) * kUnit;
    const float u = static_cast<float>((bits >> 24) & 0xffffff) * kUnit;
    // Inverse transform sampling: the distribution function of t^m is t^(m + 1).
    const float t = which < flat_       ? rim_ + (1.0f - rim_) * u
                    : which < not_bell_ ? rim_ * std::sqrt(u)
                                        : static_cast<float>(std::cbrt(double{u}));
    const glm::vec2 p = std::sqrt(1.0f - t) * directions[bits >> 52];
    const float y = p.y / l22_;
    return center_px_ + glm::vec2((p.x - l21_ * y) / l11_, y);
  }

 private:
  glm::vec2 center_px_;
  float l11_, l21_, l22_;
  float rim_;              // t at which the plateau begins
  float flat_, not_bell_;  // cumulative shares of the mixture
  float mass_;
};

/// A pixel: its open layer, and the layers that are already composited.
struct Pixel {
  glm::vec4 sum{0.0f};  // colour and opacity of the open layer's fragments
  float weight = 0.0f, distance = 0.0f;
  float far_m = -1.0f;  // far end of the open layer; negative: no layer is open
  float transmittance = 1.0f;
  glm::vec3 out{0.0f};
  float out_distance = 0.0f;

  void close() {
    if (far_m < 0.0f) return;
    const float scale = transmittance / std::max(weight, 1.0f);
    out += scale * glm::vec3(sum);
    out_distance += scale * distance;
    transmittance -= scale * sum.a;
    sum = glm::vec4(0.0f);
    weight = distance = 0.0f;
    far_m = -1.0f;
  }
};

class RasanenMethod final : public Method {
 public:
  RasanenMethod(const SurfelCloud& cloud, int samples) : cloud_(cloud), samples_(samples) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    scene_.project(cloud_, view, settings, {});
    std::vector<std::uint64_t> fragments(scene_.tileCount());
    parallelFor(fragments.size(), [&](std::size_t tile) {
      fragments[tile] = renderTile(tile, settings.lighting.background, frame);
    });
    RenderStats stats;
    stats.splats = scene_.count();
    stats.fragments = std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
    return stats;
  }

 private:
  std::uint64_t renderTile(std::size_t tile, const glm::vec3& background, Frame& frame) const {
    const glm::ivec2 begin = scene_.cornerOf(tile);
    const glm::ivec2 size = glm::min(glm::ivec2(kTile_px), frame.size_px - begin);
    std::array<Pixel, static_cast<std::size_t>(kTile_px) * kTile_px> pixels;
    const auto at = [&](int x, int y) -> Pixel& { return pixels[y * kTile_px + x]; };

    std::uint64_t fragments = 0;
    int since_start = 0;
    for (const std::uint32_t index : scene_.splatsOn(tile)) {
      if (++since_start % kSplatsBetweenChecks == 0 && isOpaque(pixels, size)) break;
      const Splat& splat = scene_.splats()[index];
      const KernelSampler kernel(splat);
      const float weight = kernel.mass() / static_cast<float>(samples_);
      if (!(weight > 0.0f && std::isfinite(weight))) continue;
      const float opacity = std::abs(splat.opacity);
      const glm::vec4 light = weight * glm::vec4(splat.red, splat.green, splat.blue, opacity);
      const float distance = weight * opacity * 0.5f * (splat.near_m + splat.far_m);
      for (int s = 0; s < samples_; ++s) {
        const glm::vec2 place =
            kernel.place_px(randomBits(std::uint64_t{index} << 24 | static_cast<std::uint64_t>(s)));
        const glm::vec2 from_corner = place - glm::vec2(begin);
        if (!(from_corner.x >= 0.0f && from_corner.y >= 0.0f)) continue;
        if (from_corner.x >= static_cast<float>(size.x)) continue;
        if (from_corner.y >= static_cast<float>(size.y)) continue;
        Pixel& pixel = at(static_cast<int>(from_corner.x), static_cast<int>(from_corner.y));
        if (splat.near_m > pixel.far_m) pixel.close();
        pixel.far_m = std::max(pixel.far_m, splat.far_m);
        pixel.weight += weight;
        pixel.sum += light;
        pixel.distance += distance;
        ++fragments;
      }
    }

    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        Pixel& pixel = at(x, y);
        pixel.close();
        const std::size_t p = static_cast<std::size_t>(begin.y + y) * frame.size_px.x + begin.x + x;
        const float covered = 1.0f - pixel.transmittance;
        frame.rgba[p] = glm::vec4(pixel.out + pixel.transmittance * background, covered);
        if (!frame.depth_m.empty()) {
          frame.depth_m[p] = covered > 0.0f ? pixel.out_distance / covered : 0.0f;
        }
      }
    }
    return fragments;
  }

  template <typename Pixels>
  static bool isOpaque(const Pixels& pixels, const glm::ivec2& size) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        if (pixels[y * kTile_px + x].transmittance >= kHidden) return false;
      }
    }
    return true;
  }

  const SurfelCloud& cloud_;
  int samples_;
  ViewSplats scene_;
};

}  // namespace

MethodEntry rasanenMethod() {
  return {.info = {.name = "rasanen",
                   .summary = "N random samples of each splat's blurred kernel",
                   .source = "Rasanen 2002",
                   .family = MethodFamily::splatting,
                   .max_n = 65536,
                   .default_n = 16},
          .make = makeAs<RasanenMethod>};
}

}  // namespace foci
