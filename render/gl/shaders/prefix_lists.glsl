// Prefix sums over the tiles' counts, and the work of the sweep: one work item for each square of
// kGroup x kGroup samples. One work group.
layout(local_size_x = 256) in;
layout(std430, binding = 0) buffer Cursors { uint cursor[]; };
layout(std430, binding = 1) writeonly buffer Ranges { uvec2 range[]; };  // by tile: begin, end
layout(std430, binding = 2) readonly buffer Tiles { ivec4 tiles[]; };
layout(std430, binding = 3) readonly buffer Blurs { float blur_px[]; };
layout(std430, binding = 4) writeonly buffer Work { uint work_items[]; };
shared uint parts[256];


void main() {
  uint me = gl_LocalInvocationID.x, tile_count = uint(cells.x * cells.y);
  uint each = (tile_count + 255u) / 256u, first = min(me * each, tile_count);
  uint end = min(first + each, tile_count), mine = 0u;
  for (uint i = first; i < end; ++i) mine += cursor[i];
  parts[me] = mine;
  SUM_UP(parts, uint)
  uint running = parts[me] - mine;
  for (uint i = first; i < end; ++i) {
    uint count = cursor[i];
    cursor[i] = running;
    range[i] = uvec2(running, running + count);
    running += count;
    if (count > longest_list) atomicMax(longest_list, count);
    ivec4 tile = tiles[i];
    if (tile.z == 0) continue;
    uint kind = cells.z == 2 && blur_px[i] > kBlurredSteps * float(tile.w) ? 1u : 0u;
    uint side = uint(samplesOf(tile) + kGroup - 1) / uint(kGroup);
    uint at = atomicAdd(work[kind], side * side);
    for (uint k = 0u; k < side * side; ++k, ++at) {
      if (at < uint(room.z)) work_items[kind * uint(room.z) + at] = i << 6 | k;
    }
  }
  if (me == 255u) list_entries = running;
  memoryBarrierBuffer();
  barrier();
  // Added by atomics, so read by one: a plain read may come from a cache.
  if (me < 3u) sweep_groups[me] = rowsOf(min(atomicAdd(work[me], 0u), uint(room.z)));
}
