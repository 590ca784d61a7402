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

#if HWY_ONCE
namespace foci {

HWY_EXPORT(compositeTileLanes);

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
  for (std::size_t k = 0; k < n; ++k) {
    const ProjectedGaussian& g = gaussians_[list_[fetched_ + k]];
    const std::array<float, kNumbers> numbers{g.x_px, g.y_px, g.vxx,   g.vxy,   g.vyy,
                                              g.sx,   g.sy,   g.e,     g.off_D, g.opacity,
                                              g.cut,  g.red,  g.green, g.blue,  g.distance_m};
    for (std::size_t i = 0; i < kNumbers; ++i) block[i * kBlock + k] = numbers[i];
  }
  fetched_ += kBlock;
}

std::size_t compositeTile(const CompositeJob& job, TileSums& sums) {
  return HWY_DYNAMIC_DISPATCH(compositeTileLanes)(job, sums);
}

}  // namespace foci
#endif  // HWY_ONCE
