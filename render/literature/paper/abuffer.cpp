// Inserts the fragments of a tile's splats into lists by block of pixels, and composites them.
#include "render/literature/paper/abuffer.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "base/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/literature/paper/abuffer.cpp"
#include <hwy/foreach_target.h>
// After it:
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "render/kernel/simd-inl.h"

#ifndef FOCI_ABUFFER_ONCE
#define FOCI_ABUFFER_ONCE
namespace foci {

/// The lists of fragments: one for each block of pixels, chained in nodes that hold one fragment of
/// every pixel of the block. A tile is divided into blocks of 4 x 4 pixels. The 16 pixels of a
/// block are consecutive in memory, row by row.
inline constexpr int kBlock = 4, kBlocks = kPaperTile_px / kBlock, kBlockPixels = kBlock * kBlock;
inline constexpr std::uint32_t kEndOfList = UINT32_MAX;

/// A pixel without a fragment has the range [inf, -inf]; it
/// has no fragment in the later nodes of the list either. `opacity` is used in transparent scenes
/// only, and `distance` only where depth is asked for.
struct alignas(64) FragmentNode {
  float near_m[kBlockPixels], far_m[kBlockPixels];
  float weight[kBlockPixels], red[kBlockPixels], green[kBlockPixels], blue[kBlockPixels];
  float opacity[kBlockPixels], distance[kBlockPixels];

  void clear(int pixel) {
    near_m[pixel] = std::numeric_limits<float>::infinity();
    far_m[pixel] = -std::numeric_limits<float>::infinity();
    for (float* sum : {weight, red, green, blue, opacity, distance}) sum[pixel] = 0.0f;
  }
  void clear() {
    for (int pixel = 0; pixel < kBlockPixels; ++pixel) clear(pixel);
  }
  bool empty(int pixel) const { return near_m[pixel] > far_m[pixel]; }

  /// Merges the other node's fragment of a pixel into this node's.
  void merge(int pixel, const FragmentNode& other) {
    near_m[pixel] = std::min(near_m[pixel], other.near_m[pixel]);
    far_m[pixel] = std::max(far_m[pixel], other.far_m[pixel]);
    weight[pixel] += other.weight[pixel];
    red[pixel] += other.red[pixel];
    green[pixel] += other.green[pixel];
    blue[pixel] += other.blue[pixel];
    opacity[pixel] += other.opacity[pixel];
    distance[pixel] += other.distance[pixel];
  }
};

/// The lists of a tile, one for each block. Node b is the first of block b's list.
struct FragmentLists {
  std::vector<FragmentNode> nodes;
  std::vector<std::uint32_t> next;  // kEndOfList after the last node

  void reset() {
    nodes.resize(kBlocks * kBlocks);
    next.assign(kBlocks * kBlocks, kEndOfList);
    for (FragmentNode& node : nodes) node.clear();
  }

  std::uint32_t append(std::uint32_t last) {
    const auto added = static_cast<std::uint32_t>(nodes.size());
    nodes.emplace_back().clear();
    next.push_back(kEndOfList);
    next[last] = added;
    return added;
  }

  /// Merges all fragments of a pixel whose ranges meet [near_m, far_m], and closes the gaps in the
  /// pixel's list.
  void join(std::uint32_t first, int pixel, float near_m, float far_m) {
    FragmentNode* into = nullptr;
    std::uint32_t write = first;
    for (std::uint32_t read = first; read != kEndOfList; read = next[read]) {
      FragmentNode& node = nodes[read];
      if (node.empty(pixel)) break;
      const bool meets = node.near_m[pixel] <= far_m && node.far_m[pixel] >= near_m;
      if (meets && into) {
        into->merge(pixel, node);
        node.clear(pixel);
        continue;
      }
      FragmentNode& kept = nodes[write];
      if (read != write) {
        kept.merge(pixel, node);
        node.clear(pixel);
      }
      if (meets) into = &kept;
      write = next[write];
    }
  }
};

/// One tile to render.
struct ABufferTile {
  const PaperSplat* splats;
  const std::uint32_t* entries;
  std::size_t count;
  int x_px, y_px;           // the tile's corner
  int width_px, height_px;  // the part of it inside the image
  float background[3];
  glm::vec4* rgba;  // the tile's corner in the frame
  float* depth_m;   // likewise; null: no depth
  std::size_t stride;
};

}  // namespace foci
#endif  // FOCI_ABUFFER_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace {

/// exp(t) for 0 <= t <= 2.5 by a minimax polynomial, within a relative error of 1.5e-5.
static_assert(kPaperCutoff == 2.5f);
HWY_INLINE V expUpToCutoff(V t) {
  const D d;
  V sum = hn::Set(d, 0.00461622058f);
  for (const float k :
       {-0.00377086746f, 0.0616816147f, 0.150727987f, 0.50572965f, 0.999270344f, 1.00001416f}) {
    sum = hn::MulAdd(sum, t, hn::Set(d, k));
  }
  return sum;
}

template <bool kTransparent, bool kDepth>
class ABuffer {
 public:
  explicit ABuffer(FragmentLists& of_thread) : lists_(of_thread) {}

  /// Renders the tile; returns its number of fragments.
  std::size_t run(const ABufferTile& job) {
    lists_.reset();
    placePixels(job);
    std::size_t fragments = 0;
    for (std::size_t e = 0; e < job.count; ++e) {
      constexpr std::size_t kAhead = 8;  // splats; chosen by hand
      if (e + kAhead < job.count) hwy::Prefetch(&job.splats[job.entries[e + kAhead]]);
      fragments += add(job.splats[job.entries[e]], static_cast<float>(job.x_px),
                       static_cast<float>(job.y_px));
    }
    resolve(job);
    return fragments;
  }

 private:
  /// Adds the splat's fragments of weight `w` to a node, at those pixels of `todo` where the ranges
  /// meet or the node has no fragment yet. Returns these pixels.
  HWY_INLINE M offer(FragmentNode& node, std::size_t part, M todo, V w, const PaperSplat& splat) {
    const D d;
    const V near_m = hn::Set(d, splat.near_m), far_m = hn::Set(d, splat.far_m);
    const V from = hn::Load(d, node.near_m + part), to = hn::Load(d, node.far_m + part);
    const M meets = hn::And(hn::Le(from, far_m), hn::Ge(to, near_m));
    const M take = hn::And(todo, hn::Or(meets, hn::Gt(from, to)));
    const V weight = hn::IfThenElseZero(take, w);
    const auto accumulate = [&](float* sum, float value) {
      hn::Store(hn::MulAdd(weight, hn::Set(d, value), hn::Load(d, sum + part)), d, sum + part);
    };
    hn::Store(hn::IfThenElse(take, hn::Min(from, near_m), from), d, node.near_m + part);
    hn::Store(hn::IfThenElse(take, hn::Max(to, far_m), to), d, node.far_m + part);
    hn::Store(hn::Add(weight, hn::Load(d, node.weight + part)), d, node.weight + part);
    accumulate(node.red, splat.red);
    accumulate(node.green, splat.green);
    accumulate(node.blue, splat.blue);
    if constexpr (kTransparent) accumulate(node.opacity, splat.opacity);
    if constexpr (kDepth) accumulate(node.distance, splat.opacity * splat.distance_m);
    return take;
  }

  /// Inserts the splat's fragments of weight `w` at the pixels `part + lane` of a block where
  /// `inside` holds.
  HWY_INLINE void insert(std::uint32_t block, std::size_t part, M inside, V w,
                         const PaperSplat& splat) {
    const M taken = offer(lists_.nodes[block], part, inside, w, splat);
    const M todo = hn::AndNot(taken, inside);
    if (HWY_LIKELY(lists_.next[block] == kEndOfList && hn::AllFalse(D(), todo))) return;
    insertBehind(block, part, inside, todo, w, splat);
  }

  /// The same for the nodes after the first. `todo`: the pixels that the first node did not take.
  HWY_NOINLINE void insertBehind(std::uint32_t block, std::size_t part, M inside, M todo, V w,
                                 const PaperSplat& splat) {
    const D d;
    M bridges = hn::FirstN(d, 0);  // pixels where the splat meets several fragments
    std::uint32_t at = block;
    while (true) {
      if (lists_.next[at] != kEndOfList) {
        at = lists_.next[at];
      } else if (hn::AllFalse(d, todo)) {
        break;
      } else {
        at = lists_.append(at);
      }
      FragmentNode& node = lists_.nodes[at];
      const V from = hn::Load(d, node.near_m + part), to = hn::Load(d, node.far_m + part);
      const M meets = hn::And(inside, hn::And(hn::Le(from, hn::Set(d, splat.far_m)),
                                              hn::Ge(to, hn::Set(d, splat.near_m))));
      if (hn::AllFalse(d, hn::Or(meets, hn::And(todo, hn::Gt(from, to))))) continue;
      const M taken = offer(node, part, todo, w, splat);
      bridges = hn::Or(bridges, hn::AndNot(taken, meets));
      todo = hn::AndNot(taken, todo);
    }
    if (HWY_LIKELY(hn::AllFalse(d, bridges))) return;
    alignas(64) float which[kBlockPixels];
    hn::Store(hn::IfThenElseZero(bridges, hn::Set(d, 1.0f)), d, which);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (which[lane] != 0.0f) {
        lists_.join(block, static_cast<int>(part + lane), splat.near_m, splat.far_m);
      }
    }
  }

  /// Adds one splat; returns its number of fragments.
  HWY_INLINE std::size_t add(const PaperSplat& splat, float tile_x_px, float tile_y_px) {
    const D d;
    const float left = splat.x_px - tile_x_px - 0.5f, top = splat.y_px - tile_y_px - 0.5f;
    const auto block = [](float pixel) {
      return static_cast<unsigned>(std::clamp(pixel, 0.0f, kPaperTile_px - 1.0f)) / kBlock;
    };
    const unsigned x0 = block(left - splat.extent_x_px), x1 = block(left + splat.extent_x_px);
    const unsigned y0 = block(top - splat.extent_y_px), y1 = block(top + splat.extent_y_px);
    const unsigned columns = x1 - x0 + 1, blocks = columns * (y1 - y0 + 1);
    const V cx = hn::Set(d, left), cy = hn::Set(d, top);
    const V qa = hn::Set(d, splat.qa), qb = hn::Set(d, splat.qb), qc = hn::Set(d, splat.qc);
    const V height = hn::Set(d, splat.height), cutoff = hn::Set(d, kPaperCutoff);

    std::size_t fragments = 0;
    // One flat loop over the blocks that the bounding box touches. Two nested short loops would
    // cost branch mispredictions.
    unsigned at = y0 * kBlocks + x0, column = 0;
    for (unsigned b = 0; b < blocks; ++b) {
      for (std::size_t part = 0; part < kBlockPixels; part += hn::Lanes(d)) {
        const std::size_t i = at * kBlockPixels + part;
        const V dx = hn::Sub(hn::Load(d, x_ + i), cx), dy = hn::Sub(hn::Load(d, y_ + i), cy);
        const V slope = hn::MulAdd(qa, dx, hn::Mul(qb, dy));
        const V t = hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(qc, dy), dy, cutoff));
        const M inside = hn::Gt(t, hn::Zero(d));
        const std::size_t count = hn::CountTrue(d, inside);
        if (count == 0) continue;
        fragments += count;
        insert(at, part, inside, hn::Mul(height, expUpToCutoff(t)), splat);
      }
      const bool row_ends = ++column == columns;
      at += row_ends ? kBlocks - columns + 1 : 1;
      column = row_ends ? 0 : column;
    }
    return fragments;
  }

  /// The composited pixels of a block.
  struct Composited {
    alignas(64) float red[kBlockPixels], green[kBlockPixels], blue[kBlockPixels];
    alignas(64) float covered[kBlockPixels], distance[kBlockPixels];
  };

  /// Composites the fragments of a block, front to back.
  HWY_INLINE void composite(std::uint32_t block, Composited& out) const {
    const D d;
    const V one = hn::Set(d, 1.0f), inf = hn::Inf(d);
    for (std::size_t part = 0; part < kBlockPixels; part += hn::Lanes(d)) {
      V red = hn::Zero(d), green = red, blue = red, distance = red, covered = red;
      V last = hn::Neg(inf);
      while (true) {
        // Find the next fragment of each pixel: the nearest one beyond the last.
        V nearest = inf, r = hn::Zero(d), g = r, b = r, w = r, o = r, z = r;
        for (std::uint32_t at = block; at != kEndOfList; at = lists_.next[at]) {
          const FragmentNode& node = lists_.nodes[at];
          const V from = hn::Load(d, node.near_m + part);
          const M nearer = hn::And(hn::Gt(from, last), hn::Lt(from, nearest));
          const auto choose = [&](V& chosen, const float* sum) {
            chosen = hn::IfThenElse(nearer, hn::Load(d, sum + part), chosen);
          };
          choose(nearest, node.near_m);
          choose(w, node.weight);
          choose(r, node.red);
          choose(g, node.green);
          choose(b, node.blue);
          if constexpr (kTransparent) choose(o, node.opacity);
          if constexpr (kDepth) choose(z, node.distance);
        }
        if (hn::AllTrue(d, hn::Eq(nearest, inf))) break;
        // Colours and opacities are weighted sums: where W > 1, both are divided by W.
        const V scale = hn::Div(one, hn::Max(w, one));
        const V passed = hn::Mul(hn::Sub(one, covered), scale);
        red = hn::MulAdd(passed, r, red);
        green = hn::MulAdd(passed, g, green);
        blue = hn::MulAdd(passed, b, blue);
        if constexpr (kDepth) distance = hn::MulAdd(passed, z, distance);
        covered = hn::MulAdd(passed, kTransparent ? o : w, covered);
        last = nearest;
        if (lists_.next[block] == kEndOfList) break;
      }
      hn::Store(red, d, out.red + part);
      hn::Store(green, d, out.green + part);
      hn::Store(blue, d, out.blue + part);
      hn::Store(covered, d, out.covered + part);
      hn::Store(distance, d, out.distance + part);
    }
  }

  /// Composites all blocks over the background, into the frame.
  void resolve(const ABufferTile& job) const {
    Composited out;
    for (std::uint32_t block = 0; block < kBlocks * kBlocks; ++block) {
      const int left = static_cast<int>(block % kBlocks) * kBlock;
      const int top = static_cast<int>(block / kBlocks) * kBlock;
      if (left >= job.width_px || top >= job.height_px) continue;
      composite(block, out);
      for (int i = 0; i < kBlockPixels; ++i) {
        const int px = left + i % kBlock, py = top + i / kBlock;
        if (px >= job.width_px || py >= job.height_px) continue;
        const float covered = out.covered[i], transmittance = 1.0f - covered;
        const std::size_t to = static_cast<std::size_t>(py) * job.stride + px;
        job.rgba[to] = {out.red[i] + transmittance * job.background[0],
                        out.green[i] + transmittance * job.background[1],
                        out.blue[i] + transmittance * job.background[2], covered};
        if (kDepth) {
          job.depth_m[to] = covered > 0.0f ? out.distance[i] / covered : 0.0f;
        }
      }
    }
  }

  void placePixels(const ABufferTile& job) {
    for (int i = 0; i < kPaperTile_px * kPaperTile_px; ++i) {
      const int block = i / kBlockPixels, pixel = i % kBlockPixels;
      const int column = block % kBlocks * kBlock + pixel % kBlock;
      const int row = block / kBlocks * kBlock + pixel / kBlock;
      const bool on_image = column < job.width_px && row < job.height_px;
      x_[i] = on_image ? static_cast<float>(column) : std::numeric_limits<float>::quiet_NaN();
      y_[i] = static_cast<float>(row);
    }
  }

  FragmentLists& lists_;
  // Pixel centres relative to the tile's first, block by block. Outside the image they are NaN,
  // which lies inside no footprint.
  alignas(64) float x_[kPaperTile_px * kPaperTile_px], y_[kPaperTile_px * kPaperTile_px];
};

}  // namespace

std::size_t renderABufferTile(const ABufferTile& job, bool transparent, FragmentLists& lists) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    ABuffer<kTransparent, kDepth> buffer(lists);
    return buffer.run(job);
  };
  if (job.depth_m)
    return transparent ? run.template operator()<true, true>()
                       : run.template operator()<false, true>();
  return transparent ? run.template operator()<true, false>()
                     : run.template operator()<false, false>();
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(renderABufferTile);

std::uint64_t renderABuffer(const PaperSplats& splats, const PaperTileLists& lists,
                            const glm::vec3& background, bool transparent, bool depth,
                            Frame& frame) {
  const glm::ivec2 tiles = lists.tiles();
  const auto tile_count = static_cast<std::size_t>(tiles.x) * tiles.y;
  std::vector<std::size_t> fragments(tile_count);
  parallelFor(tile_count, [&](std::size_t t) {
    static thread_local FragmentLists lists_of_thread;  // keeps its memory between tiles
    const auto list = lists.tile(t);
    const int x_px = static_cast<int>(t % tiles.x) * kPaperTile_px;
    const int y_px = static_cast<int>(t / tiles.x) * kPaperTile_px;
    const std::size_t corner = static_cast<std::size_t>(y_px) * frame.size_px.x + x_px;
    fragments[t] = HWY_DYNAMIC_DISPATCH(renderABufferTile)(
        {.splats = splats.splats.get(),
         .entries = list.data(),
         .count = list.size(),
         .x_px = x_px,
         .y_px = y_px,
         .width_px = std::min(kPaperTile_px, frame.size_px.x - x_px),
         .height_px = std::min(kPaperTile_px, frame.size_px.y - y_px),
         .background = {background.r, background.g, background.b},
         .rgba = frame.rgba.data() + corner,
         .depth_m = depth ? frame.depth_m.data() + corner : nullptr,
         .stride = static_cast<std::size_t>(frame.size_px.x)},
        transparent, lists_of_thread);
  });
  return std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
}

}  // namespace foci
#endif  // HWY_ONCE
