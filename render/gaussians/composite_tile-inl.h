// One tile, one sub-aperture. Included once a SIMD target.
#if defined(FOCI_COMPOSITE_TILE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_COMPOSITE_TILE_INL_H
#undef FOCI_COMPOSITE_TILE_INL_H
#else
#define FOCI_COMPOSITE_TILE_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>

#include "render/gaussians/composite.h"
#include "render/gaussians/lane_functions-inl.h"
#include "render/kernel/simd-inl.h"
#include "render/splat/field_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

inline constexpr std::size_t kMaxLanes = TileGaussians::kBlock;

/// Gaussians of a block, one lane each, as the sub-aperture sees them. At the offset (x, y)
/// from its centre a Gaussian has alpha = peak 2^-q, q = qa x^2 + qb x y + qc y^2, where q < cut.
struct alignas(64) Block {
  float x[kMaxLanes], y[kMaxLanes];  // from the tile's first sample; in samples, as all below
  float qa[kMaxLanes], qb[kMaxLanes], qc[kMaxLanes];
  float peak[kMaxLanes], cut[kMaxLanes];
  // Samples within the box of the footprint: the first and the last column and row.
  std::uint32_t left[kMaxLanes], right[kMaxLanes], top[kMaxLanes], bottom[kMaxLanes];
  std::uint64_t reach;  // bits of the lanes whose box holds a sample
};

/// The lenses of a block's lanes (`TileGaussians::lensesAt`), as `partLens` takes them.
struct LensesOfBlock {
  const float* values;
  HWY_INLINE V operator[](LocalLens::Value i) const {
    return hn::LoadU(D(), values + i * TileGaussians::kBlock);
  }
};

/// Columns and rows of the samples of squares, by place.
struct Squares {
  static constexpr std::size_t kMost = squaresOf(kMostSamples);
  alignas(64) float x[kMost][kSquarePlaces], y[kMost][kSquarePlaces];
};
inline constexpr Squares kSquares = [] {
  Squares squares{};
  for (std::size_t i = 0; i < Squares::kMost; ++i) {
    for (std::size_t place = 0; place < kSquarePlaces; ++place) {
      squares.x[i][place] = static_cast<float>(i * kSquare + place % kSquare);
      squares.y[i][place] = static_cast<float>(i * kSquare + place / kSquare);
    }
  }
  return squares;
}();

template <bool kDepth>
class TileCompositor {
 public:
  explicit TileCompositor(const CompositeJob& job)
      : job_(job),
        squares_(squaresOf(job.samples)),
        places_(placesOf(job.samples)),
        last_(static_cast<float>(job.samples - 1)) {
    std::fill_n(transmittance_, places_, 1.0f);
    makeUnusedOpaque();
    for (float* plane : {red_, green_, blue_}) std::fill_n(plane, places_, 0.0f);
    if constexpr (kDepth) std::fill_n(distance_, places_, 0.0f);
  }

  std::size_t run() {
    const std::size_t lanes = hn::Lanes(D());
    std::size_t fragments = 0;
    const std::size_t size = job_.gaussians->size();
    for (std::size_t at = 0; at < size; at += lanes) {
      const std::size_t n = std::min(lanes, size - at);
      job_.gaussians->fetch(at + n);
      see(at);
      std::uint64_t reach = block_.reach & ((std::uint64_t{1} << n) - 1);
      for (; reach != 0; reach &= reach - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(reach));
        fragments += add(k, at + k);
      }
      becomeOpaque();
      if (isOpaque()) break;
    }
    return fragments;
  }

  void addTo(TileSums& sums) const {
    const D d;
    show([&](std::size_t p, const Shown& shown) {
      const auto add = [&](V value, float* sum) {
        hn::Store(hn::Add(value, hn::Load(d, sum + p)), d, sum + p);
      };
      add(shown.light[0], sums.red);
      add(shown.light[1], sums.green);
      add(shown.light[2], sums.blue);
      add(shown.coverage, sums.coverage);
      if constexpr (kDepth) add(shown.distance_m, sums.distance_m);
    });
  }

  /// Adds the view to each of `views`, times its weight.
  void addTo(std::span<BehindPlanes> views, std::span<const float> weights) const {
    const D d;
    show([&](std::size_t p, const Shown& shown) {
      for (std::size_t i = 0; i < views.size(); ++i) {
        if (weights[i] == 0.0f) continue;
        const V weight = hn::Set(d, weights[i]);
        const auto add = [&](V value, std::size_t plane) {
          float* const sum = views[i].planes[plane] + p;
          hn::Store(hn::MulAdd(weight, value, hn::Load(d, sum)), d, sum);
        };
        for (std::size_t c = 0; c < 3; ++c) {
          add(shown.display[c], BehindPlanes::red + c);
          add(shown.light[c], BehindPlanes::light_red + c);
        }
        add(shown.coverage, BehindPlanes::coverage);
        if constexpr (kDepth) add(shown.distance_m, BehindPlanes::distance_m);
      }
    });
  }

  void follow(std::span<const std::size_t> places, std::span<SeenLight> seen) const {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::size_t at = places[i];
      seen[i] = {red_[at], green_[at], blue_[at], transmittance_[at]};
    }
  }

 private:
  struct Shown {
    V display[3], light[3], coverage, distance_m;
  };

  /// Calls `take(place, shown)` for each vector of places, over what lies behind.
  template <typename Take>
  void show(const Take& take) const {
    const D d;
    const V one = hn::Set(d, 1.0f);
    const BehindPlanes* const behind = job_.behind && !isOpaque() ? &job_.behind() : nullptr;
    const float* const planes[3] = {red_, green_, blue_};
    for (std::size_t p = 0; p < places_; p += hn::Lanes(d)) {
      const V through = hn::Load(d, transmittance_ + p);
      const auto back = [&](std::size_t plane) { return hn::Load(d, behind->planes[plane] + p); };
      Shown shown;
      for (std::size_t c = 0; c < 3; ++c) {
        const V display =
            behind ? back(BehindPlanes::red + c) : hn::Set(d, job_.background[static_cast<int>(c)]);
        shown.display[c] = hn::MulAdd(through, display, hn::Load(d, planes[c] + p));
        shown.light[c] = lightOf(shown.display[c]);
        if (behind) {
          const V more = back(BehindPlanes::light_red + c);
          shown.light[c] = hn::MulAdd(hn::Mul(through, through), more, shown.light[c]);
        }
      }
      shown.coverage = hn::Sub(one, through);
      if (behind) {
        shown.coverage = hn::MulAdd(through, back(BehindPlanes::coverage), shown.coverage);
      }
      shown.distance_m = hn::Zero(d);
      if constexpr (kDepth) {
        shown.distance_m = hn::Load(d, distance_ + p);
        if (behind) {
          shown.distance_m = hn::MulAdd(through, back(BehindPlanes::distance_m), shown.distance_m);
        }
      }
      take(p, shown);
    }
  }

  /// Fills the block with the entries from `at` on (projected.h has the formulas).
  void see(std::size_t at) {
    const D d;
    const auto load = [&](TileGaussians::Number number) {
      return hn::LoadU(d, job_.gaussians->at(number, at));
    };
    const auto set = [&](float value) { return hn::Set(d, value); };
    const V sx = load(TileGaussians::sx), sy = load(TileGaussians::sy), e = load(TileGaussians::e),
            off = load(TileGaussians::off_D);
    const glm::vec2 radius = job_.defocus->radius_px_per_D, j = job_.defocus->astigmatism_D;
    const glm::vec2 p = job_.lens.centre, a = radius * p;
    V moved_x = hn::MulAdd(off, set(a.x), set(radius.x * (j.x * p.x + j.y * p.y)));
    V moved_y = hn::MulAdd(off, set(a.y), set(radius.y * (j.y * p.x - j.x * p.y)));
    const bool field = shownField(*job_.defocus) != nullptr;
    const LensesOfBlock local{field ? job_.gaussians->lensesAt(at) : nullptr};
    PartLens lens;
    V ax = set(a.x), ay = set(a.y);  // displacement for a dioptre
    if (field) {
      lens = partLens(local, off, j, p, job_.lens.radius);
      moved_x = lens.shift_x_px;
      moved_y = lens.shift_y_px;
      ax = hn::MulAdd(lens.per_D_px.xx, set(p.x), hn::Mul(lens.per_D_px.xy, set(p.y)));
      ay = hn::MulAdd(lens.per_D_px.yx, set(p.x), hn::Mul(lens.per_D_px.yy, set(p.y)));
    }
    const float per_step = 1.0f / job_.step_px;
    const auto sampleOf = [&](V centre, V moved, float first_px) {
      return hn::Mul(hn::Add(centre, hn::Add(moved, set(-first_px))), set(per_step));
    };
    const V x = sampleOf(load(TileGaussians::x_px), moved_x, job_.first_px.x);
    const V y = sampleOf(load(TileGaussians::y_px), moved_y, job_.first_px.y);
    hn::Store(x, d, block_.x);
    hn::Store(y, d, block_.y);

    // The sheared Gaussian.
    const V minus_two = set(-2.0f);
    V xx = hn::MulAdd(hn::Mul(minus_two, ax), sx,
                      hn::MulAdd(hn::Mul(ax, ax), e, load(TileGaussians::vxx)));
    V yy = hn::MulAdd(hn::Mul(minus_two, ay), sy,
                      hn::MulAdd(hn::Mul(ay, ay), e, load(TileGaussians::vyy)));
    V xy = hn::MulAdd(hn::Neg(ax), sy, hn::MulAdd(hn::Neg(ay), sx, load(TileGaussians::vxy)));
    xy = hn::MulAdd(hn::Mul(ax, ay), e, xy);
    const auto determinant = [&] { return hn::Sub(hn::Mul(xx, yy), hn::Mul(xy, xy)); };
    const V least = set(kLowPass_px2 * kLowPass_px2);  // that of a point
    const V sharp = hn::Max(determinant(), least);

    // The disc's variance, also over the depth of the Gaussian.
    const float disc = kDiscVariancePerRadius2 * job_.lens.radius * job_.lens.radius;
    const V near_x = hn::Add(off, set(j.x)), near_y = hn::Sub(off, set(j.x));
    const V j45 = set(j.y * j.y);
    if (field) {
      const float r2 = job_.lens.radius * job_.lens.radius;
      const auto spread = [&](V bx0, V by0, V bx1, V by1, V mx0, V my0, V mx1, V my1,
                              LocalLens::Value coma, V& variance) {
        const V blur = hn::MulAdd(bx0, bx1, hn::Mul(by0, by1));
        const V depth = hn::Mul(e, hn::MulAdd(mx0, mx1, hn::Mul(my0, my1)));
        variance = hn::Add(variance, hn::MulAdd(set(disc), hn::Add(blur, depth),
                                                hn::Mul(set(r2 * r2), local[coma])));
      };
      const Matrix2 &b = lens.blur_px, &m = lens.per_D_px;
      spread(b.xx, b.xy, b.xx, b.xy, m.xx, m.xy, m.xx, m.xy, LocalLens::kCxx, xx);
      spread(b.yx, b.yy, b.yx, b.yy, m.yx, m.yy, m.yx, m.yy, LocalLens::kCyy, yy);
      spread(b.xx, b.xy, b.yx, b.yy, m.xx, m.xy, m.yx, m.yy, LocalLens::kCxy, xy);
    } else {
      xx = hn::MulAdd(set(disc * radius.x * radius.x), hn::Add(e, hn::MulAdd(near_x, near_x, j45)),
                      xx);
      yy = hn::MulAdd(set(disc * radius.y * radius.y), hn::Add(e, hn::MulAdd(near_y, near_y, j45)),
                      yy);
      xy = hn::MulAdd(set(2.0f * disc * radius.x * radius.y * j.y), off, xy);
    }
    const V blurred = hn::Max(determinant(), least);
    if constexpr (kDepth) {
      const V per_variance = hn::Div(set(job_.step_px), blurred);
      const V tx = hn::NegMulAdd(ax, e, sx), ty = hn::NegMulAdd(ay, e, sy);
      vergences_.see(load(TileGaussians::distance_m), e,
                     hn::Mul(hn::Sub(hn::Mul(yy, tx), hn::Mul(xy, ty)), per_variance),
                     hn::Mul(hn::Sub(hn::Mul(xx, ty), hn::Mul(xy, tx)), per_variance));
    }

    constexpr float kHalfLog2E = 0.5f * std::numbers::log2e_v<float>;
    const V scale = hn::Div(set(kHalfLog2E * job_.step_px * job_.step_px), blurred);
    const V cut = load(TileGaussians::cut);
    hn::Store(hn::Mul(yy, scale), d, block_.qa);
    hn::Store(hn::Mul(hn::Mul(set(-2.0f), xy), scale), d, block_.qb);
    hn::Store(hn::Mul(xx, scale), d, block_.qc);
    // The covered area stays; exp(opacity - 1) is the peak of a flat top (gaussian_merge.h).
    const V opacity = hn::Mul(load(TileGaussians::opacity), hn::Sqrt(hn::Div(sharp, blurred)));
    const V above = hn::Mul(hn::Sub(opacity, set(1.0f)), set(std::numbers::log2e_v<float>));
    const V flat = powerOfHalf(hn::Neg(hn::Clamp(above, hn::Zero(d), set(kMaxPeakExponent))));
    hn::Store(hn::IfThenElse(hn::Gt(above, hn::Zero(d)), flat, opacity), d, block_.peak);
    hn::Store(hn::Mul(cut, set(kHalfLog2E)), d, block_.cut);
    const auto boxOf = [&](V centre, V variance, std::uint32_t* first, std::uint32_t* last) {
      const V half = hn::Mul(hn::Sqrt(hn::Mul(cut, variance)), set(per_step));
      const V low = hn::Ceil(hn::Sub(centre, half)), high = hn::Floor(hn::Add(centre, half));
      const V from = hn::Max(low, hn::Zero(d)), to = hn::Min(high, set(last_));
      const M holds_sample = hn::Le(from, to);  // false for values that are not finite
      const hn::RebindToSigned<D> di;
      const hn::RebindToUnsigned<D> du;
      const auto store = [&](V sample, std::uint32_t* stored) {
        hn::Store(hn::BitCast(du, hn::ConvertTo(di, hn::IfThenElseZero(holds_sample, sample))), du,
                  stored);
      };
      store(from, first);
      store(to, last);
      return holds_sample;
    };
    const M in_columns = boxOf(x, xx, block_.left, block_.right);
    const M in_rows = boxOf(y, yy, block_.top, block_.bottom);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::And(in_columns, in_rows), bits);
    std::memcpy(&block_.reach, bits, sizeof(block_.reach));
  }

  /// Composites lane `k` of the block, an entry of the tile, behind what the tile holds. @return
  /// samples inside
  std::size_t add(std::size_t k, std::size_t entry) {
    const D d;
    // A vector of places is a strip of a square: kSquare columns, and `rows` rows.
    const std::size_t rows = hn::Lanes(d) / kSquare, strips = kSquare / rows;
    const std::size_t left = block_.left[k] / kSquare, right = block_.right[k] / kSquare;
    const std::size_t first = block_.top[k] / rows, last = block_.bottom[k] / rows;
    const V x = hn::Set(d, block_.x[k]), y = hn::Set(d, block_.y[k]);
    const V qa = hn::Set(d, block_.qa[k]), qb = hn::Set(d, block_.qb[k]);
    const V qc = hn::Set(d, block_.qc[k]), cut = hn::Set(d, block_.cut[k]);
    const V peak = hn::Set(d, block_.peak[k]), most = hn::Set(d, kMaxAlphaOfGaussian);
    const auto number = [&](TileGaussians::Number which) {
      return hn::Set(d, *job_.gaussians->at(which, entry));
    };
    const V red = number(TileGaussians::red), green = number(TileGaussians::green);
    const V blue = number(TileGaussians::blue);
    const V opaque = hn::Set(d, kOpaqueTransmittance);
    std::size_t inside = 0;
    // One loop over all strips of squares, so that only its end is hard to predict.
    std::size_t strip = first, square = left;
    for (std::size_t n = (last - first + 1) * (right - left + 1); n > 0; --n) {
      const std::size_t in_square = strip % strips * hn::Lanes(d);
      const V dy = hn::Sub(hn::Load(d, kSquares.y[strip / strips] + in_square), y);
      const V dx = hn::Sub(hn::Load(d, kSquares.x[square] + in_square), x);
      const V slope = hn::Mul(qb, dy), rest = hn::Mul(hn::Mul(qc, dy), dy);
      const V q = hn::MulAdd(hn::MulAdd(qa, dx, slope), dx, rest);
      const std::size_t at = (strip / strips * squares_ + square) * kSquarePlaces + in_square;
      const bool row_ends = square == right;
      square = row_ends ? left : square + 1;
      strip += row_ends;
      const V through = hn::Load(d, transmittance_ + at);
      const M in = hn::And(hn::Lt(q, cut), hn::Gt(through, opaque));
      inside += hn::CountTrue(d, in);
      // The limits keep lanes outside from denormal numbers, which cost 100 times as much.
      const V within = hn::Min(hn::Max(q, hn::Zero(d)), cut);
      const V alpha = hn::IfThenElseZero(in, hn::Min(hn::Mul(peak, powerOfHalf(within)), most));
      const V seen = hn::Mul(through, alpha);
      hn::Store(hn::Sub(through, seen), d, transmittance_ + at);
      hn::Store(hn::MulAdd(seen, red, hn::Load(d, red_ + at)), d, red_ + at);
      hn::Store(hn::MulAdd(seen, green, hn::Load(d, green_ + at)), d, green_ + at);
      hn::Store(hn::MulAdd(seen, blue, hn::Load(d, blue_ + at)), d, blue_ + at);
      if constexpr (kDepth) {
        const V vergence = vergences_.ofSamples(k, dx, dy);
        hn::Store(hn::Add(hn::Div(seen, vergence), hn::Load(d, distance_ + at)), d, distance_ + at);
      }
    }
    return inside;
  }

  void makeUnusedOpaque() {
    const auto samples = static_cast<std::size_t>(job_.samples), end = squares_ * kSquare;
    for (std::size_t i = samples; i < end; ++i) {
      for (std::size_t j = 0; j < end; ++j) {
        transmittance_[placeOf(job_.samples, i, j)] = 0.0f;
        transmittance_[placeOf(job_.samples, j, i)] = 0.0f;
      }
    }
  }

  /// Places that are opaque stay so. Each call continues where the last one ended.
  void becomeOpaque() {
    const D d;
    const V opaque = hn::Set(d, kOpaqueTransmittance);
    while (!isOpaque() &&
           hn::AllTrue(d, hn::Le(hn::Load(d, transmittance_ + opaque_places_), opaque))) {
      opaque_places_ += hn::Lanes(d);
    }
  }
  bool isOpaque() const { return opaque_places_ >= places_; }

  const CompositeJob& job_;
  std::size_t squares_, places_;   // along a side; in all
  float last_;                     // index of the last sample of a row
  std::size_t opaque_places_ = 0;  // all places before it are opaque
  Block block_;
  Vergences vergences_;  // with kDepth
  alignas(64) float transmittance_[kTilePlaces];
  alignas(64) float red_[kTilePlaces], green_[kTilePlaces], blue_[kTilePlaces];
  alignas(64) float distance_[kDepth ? kTilePlaces : 1];
};

template <typename Add>
std::size_t composite(const CompositeJob& job, const Add& add) {
  const auto run = [&]<bool kDepth>() {
    TileCompositor<kDepth> tile(job);
    const std::size_t fragments = tile.run();
    add(tile);
    return fragments;
  };
  return job.depth ? run.template operator()<true>() : run.template operator()<false>();
}

inline std::size_t compositeTileLanes(const CompositeJob& job, TileSums& sums,
                                      std::span<const std::size_t> followed,
                                      std::span<SeenLight> seen) {
  return composite(job, [&](const auto& tile) {
    tile.addTo(sums);
    tile.follow(followed, seen);
  });
}

inline std::size_t seeTileLanes(const CompositeJob& job, std::span<const std::size_t> followed,
                                std::span<SeenLight> seen) {
  return composite(job, [&](const auto& tile) { tile.follow(followed, seen); });
}

inline std::size_t compositeBehindLanes(const CompositeJob& job, std::span<const float> weights,
                                        std::span<BehindPlanes> views,
                                        std::span<const std::size_t> followed,
                                        std::span<SeenLight> seen) {
  return composite(job, [&](const auto& tile) {
    tile.addTo(views, weights);
    tile.follow(followed, seen);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_COMPOSITE_TILE_INL_H
