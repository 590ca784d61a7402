// Lists the nodes of the cut, a parent before its children and these from left to right, its
// surfels, and the surfels of whole nodes: the order of the CPU's cut, so that both take splats at
// one distance in the same order. Compiled twice: the first pass
// counts the entries of each work group, the second (with FILL) writes them after a prefix sum.
layout(local_size_x = 256) in;

layout(std430, binding = 0) readonly buffer Own { float own[]; };
layout(std430, binding = 1) readonly buffer Passed { float passed[]; };
layout(std430, binding = 2) buffer Sums { uvec4 sums[]; };  // by work group: nodes, surfels, surfels of whole nodes
layout(std430, binding = 4) writeonly buffer Entries { uvec2 entries[]; };  // index, weight

const uint kNodesAThread = 8u;
shared uvec4 counts[256];

// n j >> level, where n j may take 64 bits.
uint shareOf(uint n, uint j, int level) {
  uint high, low;
  umulExtended(n, j, high, low);
  return level == 0 ? low : (high << (32 - level)) | (low >> level);
}

uvec2 surfelsOf(uint node) {
  int level = scene.y - 1;
  uint j = node - (1u << level);
  return uvec2(shareOf(uint(scene.x), j, level), shareOf(uint(scene.x), j + 1u, level));
}

// The node at a place of the order, 0 to the number of nodes - 2; the root is 1.
uint nodeAt(uint place) {
  uint node = 1u;
  for (int level = scene.y - 1; place > 0u; --level) {
    uint half_ = (1u << level) - 1u;  // nodes below a child
    --place;
    node *= 2u;
    if (place >= half_) {
      place -= half_;
      ++node;
    }
  }
  return node;
}

void main() {
  uint node_count = 1u << scene.y, first_cluster = node_count >> 1;
  uint group = groupIndex(), me = gl_LocalInvocationID.x;
  if (group * 256u * kNodesAThread >= node_count) return;
  uint first = (group * 256u + me) * kNodesAThread;
  uint end = min(first + kNodesAThread, node_count - 1u);
  uvec4 count = uvec4(0u);
  for (uint place = first; place < end; ++place) {
    uint node = nodeAt(place);
    if (own[node] > 0.0) ++count.x;
    if (node >= first_cluster && passed[node] > 0.0) {
      uvec2 range = surfelsOf(node);
      count[passed[node] == kWhole ? 2 : 1] += range.y - range.x;
    }
  }
  counts[me] = count;
  SUM_UP(counts, uvec4)
#ifdef FILL
  uvec4 at = sums[group] + counts[me] - count;
  at.yz += uvec2(cut_nodes, cut_whole);
  uint capacity = uint(room.x);
  for (uint place = first; place < end; ++place) {
    uint node = nodeAt(place);
    if (own[node] > 0.0) {
      if (at.x < capacity) entries[at.x] = uvec2(node, floatBitsToUint(own[node]));
      ++at.x;
    }
    if (node >= first_cluster && passed[node] > 0.0) {
      uvec2 range = surfelsOf(node);
      int kind = passed[node] == kWhole ? 2 : 1;
      for (uint i = range.x; i < range.y; ++i, ++at[kind]) {
        if (at[kind] < capacity) {
          entries[at[kind]] = uvec2(i, floatBitsToUint(min(passed[node], 1.0)));
        }
      }
    }
  }
#else
  if (me == 255u) sums[group] = counts[255];
#endif
}
