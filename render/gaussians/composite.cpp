#include "render/gaussians/composite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/gaussians/composite.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After foreach_target.h:
#include "render/gaussians/composite_tile-inl.h"
#include "render/gaussians/interpolate_behind-inl.h"

#if HWY_ONCE
namespace foci {

HWY_EXPORT(compositeTileLanes);
HWY_EXPORT(seeTileLanes);
HWY_EXPORT(compositeBehindLanes);
HWY_EXPORT(interpolateBehindLanes);

std::vector<SubApertureSize> subApertureSizes(const std::vector<LensDisc>& discs) {
  std::vector<SubApertureSize> sizes;
  for (const LensDisc& disc : discs) {
    const SubApertureSize each{glm::length(disc.centre), disc.radius};
    // Of discs of one size, the farthest from the middle bounds the others.
    if (sizes.empty() || sizes.back().aperture != each.aperture) {
      sizes.push_back(each);
    } else {
      sizes.back().max_radius = std::max(sizes.back().max_radius, each.max_radius);
    }
  }
  return sizes;
}

void TileGaussians::begin(const ProjectedGaussian* gaussians, std::span<const std::uint32_t> list) {
  gaussians_ = gaussians;
  list_ = list;
  fetched_ = 0;
  const std::size_t needed = (list.size() + kBlock - 1) / kBlock * kBlock * kNumbers;
  if (values_.size() < needed) values_.resize(needed);
}

void TileGaussians::fetchBlock() {
  float* const block = values_.data() + fetched_ * kNumbers;
  const std::size_t n = std::min(kBlock, list_.size() - fetched_);
  std::fill_n(block, kBlock * kNumbers, 0.0f);
  // They lie scattered in memory.
  const std::size_t next = std::min(fetched_ + kBlock, list_.size());
  for (const std::uint32_t i : list_.subspan(next, std::min(kBlock, list_.size() - next))) {
    __builtin_prefetch(gaussians_ + i);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const ProjectedGaussian& g = gaussians_[list_[fetched_ + k]];
    const std::array<float, kNumbers> numbers{g.x_px, g.y_px, g.vxx,   g.vxy,   g.vyy,
                                              g.sx,   g.sy,   g.e,     g.off_D, g.opacity,
                                              g.cut,  g.red,  g.green, g.blue,  g.distance_m};
    for (std::size_t i = 0; i < kNumbers; ++i) block[i * kBlock + k] = numbers[i];
  }
  fetched_ += kBlock;
}

std::size_t compositeTile(const CompositeJob& job, TileSums& sums,
                          std::span<const std::size_t> followed, std::span<SeenLight> seen) {
  return HWY_DYNAMIC_DISPATCH(compositeTileLanes)(job, sums, followed, seen);
}

std::size_t seeTile(const CompositeJob& job, std::span<const std::size_t> followed,
                    std::span<SeenLight> seen) {
  return HWY_DYNAMIC_DISPATCH(seeTileLanes)(job, followed, seen);
}

std::size_t compositeBehind(const CompositeJob& job, std::span<const float> weights,
                            std::span<BehindPlanes> views, std::span<const std::size_t> followed,
                            std::span<SeenLight> seen) {
  return HWY_DYNAMIC_DISPATCH(compositeBehindLanes)(job, weights, views, followed, seen);
}

void interpolateBehind(const Resampling& resampling, BehindPlanes& from, BehindPlanes& to) {
  HWY_DYNAMIC_DISPATCH(interpolateBehindLanes)(resampling, from, to);
}

}  // namespace foci
#endif  // HWY_ONCE
