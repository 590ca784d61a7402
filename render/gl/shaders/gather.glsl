// Lists the nodes and the surfels of the cut, in their own order. Compiled twice: the first pass
// counts the entries of each work group, the second (with FILL) writes them after a prefix sum.
layout(local_size_x = 256) in;

layout(std430, binding = 0) readonly buffer Own { float own[]; };
layout(std430, binding = 1) readonly buffer Passed { float passed[]; };
layout(std430, binding = 2) buffer Sums { uvec2 sums[]; };         // by work group: nodes, surfels
layout(std430, binding = 4) writeonly buffer Entries { uvec2 entries[]; };  // index, weight

const uint kNodesAThread = 8u;
shared uvec2 counts[256];

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

void main() {
  uint node_count = 1u << scene.y, first_cluster = node_count >> 1;
  uint me = gl_LocalInvocationID.x;
  uint first = (gl_WorkGroupID.x * 256u + me) * kNodesAThread;
  uvec2 count = uvec2(0u);
  for (uint node = max(first, 1u); node < min(first + kNodesAThread, node_count); ++node) {
    if (own[node] > 0.0) ++count.x;
    if (node >= first_cluster && passed[node] > 0.0) {
      uvec2 range = surfelsOf(node);
      count.y += range.y - range.x;
    }
  }
  counts[me] = count;
  barrier();
  for (uint step = 1u; step < 256u; step *= 2u) {
    uvec2 before = me >= step ? counts[me - step] : uvec2(0u);
    barrier();
    counts[me] += before;
    barrier();
  }
#ifdef FILL
  uvec2 at = sums[gl_WorkGroupID.x] + counts[me] - count;
  at.y += cut_nodes;  // surfels follow all nodes
  uint capacity = uint(room.x);
  for (uint node = max(first, 1u); node < min(first + kNodesAThread, node_count); ++node) {
    if (own[node] > 0.0) {
      if (at.x < capacity) entries[at.x] = uvec2(node, floatBitsToUint(own[node]));
      ++at.x;
    }
    if (node >= first_cluster && passed[node] > 0.0) {
      uvec2 range = surfelsOf(node);
      for (uint i = range.x; i < range.y; ++i, ++at.y) {
        if (at.y < capacity) entries[at.y] = uvec2(i, floatBitsToUint(passed[node]));
      }
    }
  }
#else
  if (me == 255u) sums[gl_WorkGroupID.x] = counts[255];
#endif
}
