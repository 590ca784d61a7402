// Composites the surfels of one ray into layers, by the rules of the sweep (render/splat/sweep.h).
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "render/kernel/kernel.h"
#include "render/kernel/pixel_edge.h"
#include "render/literature/raytrace/disc_scene.h"

namespace foci {

/// Weighted sums over splats.
struct SplatSums {
  float weight = 0.0f, opacity = 0.0f, distance = 0.0f;
  glm::vec3 color{0.0f};

  void add(const SeenSurfel& surfel, float w) {
    weight += w;
    opacity += w * surfel.opacity;
    distance += w * surfel.opacity * 0.5f * (surfel.near_m + surfel.far_m);
    color += w * surfel.color;
  }

  void add(const SplatSums& other, float f) {
    weight += f * other.weight;
    opacity += f * other.opacity;
    distance += f * other.distance;
    color += f * other.color;
  }
};

/// One side of a layer's surface: splats until it is opaque, and the mean offset of all of them.
struct RaySide : SplatSums {
  float all = 0.0f;        ///< weight, that of later splats too
  glm::vec2 offset{0.0f};  ///< `all` times the offsets of `Hit`

  float share() const { return pixelCoverageOf(all, mean()); }
  glm::vec2 mean() const { return offset / std::max(all, 1e-20f); }
  PixelEdge edge() const { return pixelEdgeOf(all, mean(), share()); }
};

/// An open layer. `later` holds the weight that front-facing splats add once the front is opaque.
struct RayLayer {
  RaySide front, back;
  SplatSums later;

  void add(const SeenSurfel& surfel, const Hit& hit) {
    const float w = hit.weight;
    RaySide& side = surfel.back_facing ? back : front;
    const float joins = std::min(w, std::max(kOpaqueWeight - side.weight, 0.0f));
    side.add(surfel, joins);
    side.all += w;
    side.offset += w * hit.offset;
    if (!surfel.back_facing && w > joins) later.add(surfel, w - joins);
  }
};

/// The composited layers of a ray.
class RayColor {
 public:
  glm::vec3 color{0.0f};
  float distance = 0.0f;  ///< times coverage
  float transmittance = 1.0f;

  void close(RayLayer layer, bool transparent) {
    if (!transparent) layer.later = {};
    const float covered = layer.front.share();
    const float left = besideFront(layer.front.edge(), layer.back.edge());
    const PixelEdge behind = edgeOf(layer, left);
    const float seen = edge_ ? seenOverIndependent(edge_->edge, edge_->opacity, behind) : 1.0f;
    // The later weight is noise of the same surface, another surface, or a share of each.
    const float less = (kAnother - layer.later.weight) / (kAnother - kNoise);
    const float same = std::clamp(less, 0.0f, 1.0f);
    layer.front.add(layer.later, same);
    layer.later.add(layer.later, -same);
    const float front_scale = covered / std::max(layer.front.weight, 1e-20f);
    const float back_scale = left / std::max(layer.back.weight, 1e-20f);
    keepEdge(behind, front_scale * layer.front.opacity + back_scale * layer.back.opacity, seen);
    composite(layer.front, seen * front_scale, layer.back, seen * back_scale);
    composite(layer.later, 1.0f / std::max(layer.later.weight, 1.0f), {}, 0.0f);
  }

 private:
  /// A layer that covers the pixel in part.
  struct FrontEdge {
    PixelEdge edge;
    float opacity, contrast;
  };
  std::optional<FrontEdge> edge_;  ///< of most contrast

  static PixelEdge edgeOf(const RayLayer& layer, float left) {
    const float share = layer.front.share() + left;
    const glm::vec2 mean =
        glm::mix(layer.front.mean(), layer.back.mean(), left / std::max(share, 1e-20f));
    return pixelEdgeOf(std::max(layer.front.all, layer.back.all), mean, share);
  }

  void keepEdge(const PixelEdge& edge, float independent_alpha, float seen) {
    const float independent = std::min(independent_alpha, 1.0f);
    if (!(edge.share > kPartial && seen * independent_alpha < 1.0f - kPartial)) return;
    const float contrast = independent / std::max(1.0f - independent, 1e-3f);
    if (edge_ && contrast <= edge_->contrast) return;
    edge_ = {edge, std::min(independent / edge.share, 1.0f), contrast};
  }

  void composite(const SplatSums& a, float a_scale, const SplatSums& b, float b_scale) {
    color += transmittance * (a_scale * a.color + b_scale * b.color);
    distance += transmittance * (a_scale * a.distance + b_scale * b.distance);
    transmittance *= 1.0f - std::min(a_scale * a.opacity + b_scale * b.opacity, 1.0f);
  }
};

/// @param hits  from the nearest to the farthest
inline RayColor composite(const std::vector<SeenSurfel>& surfels, bool transparent,
                          const std::vector<Hit>& hits) {
  RayColor seen;
  RayLayer open;
  float open_far_m = -1.0f;
  for (const Hit& hit : hits) {
    const SeenSurfel& surfel = surfels[hit.surfel];
    if (surfel.near_m > open_far_m || open.later.weight >= 1.0f) {
      seen.close(open, transparent);
      open = {};
      open_far_m = -1.0f;
      if (seen.transmittance < kHidden) return seen;
    }
    open_far_m = std::max(open_far_m, surfel.far_m);
    open.add(surfel, hit);
  }
  seen.close(open, transparent);
  return seen;
}

}  // namespace foci
