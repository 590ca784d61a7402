// The splats of each tile. Compiled twice: the first pass counts them, the second (with FILL)
// writes them, in no order.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Keys { uvec4 keys[]; };
layout(std430, binding = 1) readonly buffer TileOfCell { uint tile_of_cell[]; };
layout(std430, binding = 2) readonly buffer Tiles { ivec4 tiles[]; };
layout(std430, binding = 3) buffer Cursors { uint cursor[]; };  // by tile
#ifdef FILL
layout(std430, binding = 4) writeonly buffer Lists { uvec2 list[]; };  // order, splat

#endif

void main() {
  uint slot = threadIndex(64u);
  if (slot >= min(cut_entries, uint(room.x))) return;
  uvec4 key = keys[slot];
  ivec2 low = ivec2(key.yz & 0x7FFFu), high = ivec2(key.yz >> 15 & 0x7FFFu);
  if (low.x > high.x) return;
#ifdef FILL
  int shift = max(findMSB(farthest - nearest) + 1 - kKeyBits, 0);
  uint order = (key.x - nearest) >> shift;
#endif
  int max_apron = size.w != 0 ? kApron * kMaxStep_px : 0;
  ivec2 first = max(low - max_apron, 0) / kTile;
  ivec2 last = min(high + max_apron, size.xy - 1) / kTile;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x;) {
      uint index = tile_of_cell[y * cells.x + x];
      ivec4 tile = tiles[index];
      x = (tile.x + tile.z) / kTile;
      if (y != max(tile.y / kTile, first.y)) continue;  // visited in an earlier row
      int apron = tile.w > 1 ? kApron * tile.w : 0;
      if (any(lessThan(high, tile.xy - apron)) ||
          any(greaterThanEqual(low, tile.xy + tile.z + apron))) {
        continue;
      }
      uint at = atomicAdd(cursor[index], 1u);
#ifdef FILL
      if (at < uint(room.y)) list[at] = uvec2(order, slot);
#endif
    }
  }
}
