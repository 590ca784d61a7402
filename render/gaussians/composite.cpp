#include "render/gaussians/composite.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/gaussians/composite.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After foreach_target.h:
#include "render/gaussians/composite_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Room for a row of samples, in whole vectors.
inline constexpr std::size_t kRow = (kMostSamples + 15) / 16 * 16;

/// A sample among those that it is interpolated from: the first of four, and their taps.
struct Taps {
  std::size_t first = 0;
  std::array<float, 4> weights{};
};

/// Cubics (Catmull and Rom 1974). Beyond the edges, the parabola through the last three samples
/// goes on.
inline std::array<Taps, kMostSamples> tapsOf(const Resampling& resampling) {
  const int last = resampling.from_samples - 1;
  std::array<Taps, kMostSamples> taps;
  for (int i = 0; i < resampling.to_samples; ++i) {
    const float at = resampling.first + resampling.step * static_cast<float>(i);
    const int below = std::min(static_cast<int>(at), last - 1);
    const auto w = catmullRom(at - static_cast<float>(below));
    Taps& each = taps[static_cast<std::size_t>(i)];
    if (below == 0) {
      each = {0, {w[1] + 3.0f * w[0], w[2] - 3.0f * w[0], w[3] + w[0], 0.0f}};
    } else if (below == last - 1) {
      each = {static_cast<std::size_t>(last - 3),
              {0.0f, w[0] + w[3], w[1] - 3.0f * w[3], w[2] + 3.0f * w[3]}};
    } else {
      each = {static_cast<std::size_t>(below - 1), w};
    }
  }
  return taps;
}

inline void interpolateBehindLanes(const Resampling& resampling, BehindPlanes& from,
                                   BehindPlanes& to) {
  const D d;
  for (std::size_t p = 0; p < placesOf(resampling.from_samples); p += hn::Lanes(d)) {
    for (std::size_t c = 0; c < 3; ++c) {
      float* const light = from.planes[BehindPlanes::light_red + c] + p;
      const V display = hn::Load(d, from.planes[BehindPlanes::red + c] + p);
      hn::Store(hn::Sub(hn::Load(d, light), lightOf(display)), d, light);
    }
  }
  const auto taps = tapsOf(resampling);
  const auto samples = static_cast<std::size_t>(resampling.to_samples);
  alignas(64) float rows[kMostSamples][kRow] = {};
  alignas(64) float row[kRow];
  for (std::size_t plane = 0; plane < BehindPlanes::kPlanes; ++plane) {
    for (std::size_t y = 0; y < static_cast<std::size_t>(resampling.from_samples); ++y) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(resampling.from_samples); ++x) {
        row[x] = from.planes[plane][placeOf(resampling.from_samples, x, y)];
      }
      for (std::size_t x = 0; x < samples; ++x) {
        const auto& [first, w] = taps[x];
        rows[y][x] = w[0] * row[first] + w[1] * row[first + 1] + w[2] * row[first + 2] +
                     w[3] * row[first + 3];
      }
    }
    for (std::size_t y = 0; y < samples; ++y) {
      const auto& [first, w] = taps[y];
      for (std::size_t x = 0; x < samples; x += hn::Lanes(d)) {
        V sum = hn::Mul(hn::Set(d, w[0]), hn::Load(d, rows[first] + x));
        for (std::size_t k = 1; k < w.size(); ++k) {
          sum = hn::MulAdd(hn::Set(d, w[k]), hn::Load(d, rows[first + k] + x), sum);
        }
        hn::Store(sum, d, row + x);
      }
      for (std::size_t x = 0; x < samples; x += kSquare) {
        std::copy_n(row + x, kSquare, to.planes[plane] + placeOf(resampling.to_samples, x, y));
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

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

void TileGaussians::begin(const ProjectedGaussian* gaussians, std::span<const std::uint32_t> list,
                          const LensField* field, const glm::vec2& principal_px) {
  field_ = field;
  principal_px_ = principal_px;
  gaussians_ = gaussians;
  list_ = list;
  fetched_ = 0;
  const std::size_t needed = (list.size() + kBlock - 1) / kBlock * kBlock * kNumbers;
  if (values_.size() < needed) values_.resize(needed);
  const std::size_t lenses = field ? needed / kNumbers * LocalLens::kValues : 0;
  if (lenses_.size() < lenses) lenses_.resize(lenses);
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
  if (field_) {
    float* const lenses = lenses_.data() + fetched_ * LocalLens::kValues;
    for (std::size_t k = 0; k < kBlock; ++k) {
      const glm::vec2 at_px(block[x_px * kBlock + k], block[y_px * kBlock + k]);
      const LocalLens lens = field_->at(at_px - principal_px_);
      for (std::size_t i = 0; i < LocalLens::kValues; ++i) {
        lenses[i * kBlock + k] = lens.values[i];
      }
    }
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
