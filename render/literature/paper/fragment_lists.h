// The lists of fragments of the paper's A-buffer: one list for each block of pixels, chained in
// nodes that hold one fragment of every pixel of the block.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/literature/paper/splat.h"

namespace foci {

/// A tile is divided into blocks of 4 x 4 pixels. The 16 pixels of a block are consecutive in
/// memory, row by row.
inline constexpr int kBlock = 4, kBlocks = kPaperTile_px / kBlock, kBlockPixels = kBlock * kBlock;
inline constexpr std::uint32_t kEndOfList = UINT32_MAX;

/// One fragment of each pixel of a block. A pixel without a fragment has the range [inf, -inf]; it
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

}  // namespace foci
