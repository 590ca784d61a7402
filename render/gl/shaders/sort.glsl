// Sorts the splats of each tile by distance, then by splat, so that the order is always the same.
// One work group a tile: bitonic networks in shared memory for runs of kRun, then merges, in which
// each splat finds its place by a binary search.
layout(local_size_x = 256) in;
layout(std430, binding = 0) coherent buffer Lists { uvec2 list[]; };
layout(std430, binding = 1) coherent buffer Scratch { uvec2 scratch[]; };
layout(std430, binding = 2) readonly buffer Ranges { uvec2 range[]; };
const uint kRun = 2048u;
shared uvec2 run[kRun];

bool before(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

void sortRun(uint begin, uint count) {
  uint me = gl_LocalInvocationID.x, power = 1u;
  while (power < count) power *= 2u;
  for (uint i = me; i < power; i += 256u) run[i] = i < count ? list[begin + i] : uvec2(kNone);
  barrier();
  for (uint size_ = 2u; size_ <= power; size_ *= 2u) {
    for (uint stride = size_ / 2u; stride > 0u; stride /= 2u) {
      for (uint i = me; i < power / 2u; i += 256u) {
        uint a = 2u * i - (i & (stride - 1u)), b = a + stride;
        bool up = (a & size_) == 0u;
        uvec2 first = run[a], second = run[b];
        if (before(second, first) == up) {
          run[a] = second;
          run[b] = first;
        }
      }
      barrier();
    }
  }
  for (uint i = me; i < count; i += 256u) list[begin + i] = run[i];
  barrier();
}

// How many of the sorted [from, end) come before `item`.
uint rankIn(uint from, uint end, uvec2 item, bool in_list) {
  uint low = from, high = end;
  while (low < high) {
    uint middle = (low + high) / 2u;
    if (before(in_list ? list[middle] : scratch[middle], item)) low = middle + 1u;
    else high = middle;
  }
  return low - from;
}

void main() {
  uint tile = groupIndex(), me = gl_LocalInvocationID.x;
  if (tile >= uint(cells.x * cells.y)) return;
  uint begin = min(range[tile].x, uint(room.y)), end = min(range[tile].y, uint(room.y));
  uint count = end - begin;
  if (count < 2u) return;
  for (uint at = 0u; at < count; at += kRun) sortRun(begin + at, min(kRun, count - at));
  bool in_list = true;
  for (uint width = kRun; width < count; width *= 2u) {
    memoryBarrierBuffer();
    barrier();
    for (uint i = me; i < count; i += 256u) {
      uint pair = i / (2u * width) * 2u * width, middle = min(pair + width, count);
      uint last = min(pair + 2u * width, count);
      uvec2 item = in_list ? list[begin + i] : scratch[begin + i];
      uint at = i < middle ? i + rankIn(begin + middle, begin + last, item, in_list)
                           : i - middle + pair + rankIn(begin + pair, begin + middle, item, in_list);
      if (in_list) scratch[begin + at] = item;
      else list[begin + at] = item;
    }
    in_list = !in_list;
  }
  if (in_list) return;
  memoryBarrierBuffer();
  barrier();
  for (uint i = me; i < count; i += 256u) list[begin + i] = scratch[begin + i];
}
