// By cell, the smallest tile: the finest step that a splat asks for, and the largest blur
// (TileLists::blurOfCells of render/splat/bin.cpp).
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Keys { uvec4 keys[]; };
layout(std430, binding = 1) buffer Cells { uvec2 of_cell[]; };  // log2 of the step; bits of the blur

int reachOf(int step_px) { return 3 * step_px / 2; }

void main() {
  uint slot = threadIndex(64u);
  if (slot >= min(cut_entries, uint(room.x))) return;
  uvec4 key = keys[slot];
  ivec2 low = ivec2(key.yz & 0x7FFFu), high = ivec2(key.yz >> 15 & 0x7FFFu);
  if (low.x > high.x) return;
  uint own = key.y >> 30;
  ivec2 first = max(low - reachOf(kMaxStep_px), 0) / kTile;
  ivec2 last = min(high + reachOf(kMaxStep_px), size.xy - 1) / kTile;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      int cell = y * cells.x + x;
      uint log2_step = own;
      if (of_cell[cell].x > own) {
        ivec2 corner = ivec2(x, y) * kTile;
        ivec2 apart = max(corner - high, low - corner - kTile + 1);
        int apart_px = max(apart.x, apart.y);
        while (log2_step < 3u && apart_px > reachOf(2 << log2_step)) ++log2_step;
        if (of_cell[cell].x > log2_step) atomicMin(of_cell[cell].x, log2_step);
      }
      if (of_cell[cell].y < key.w) atomicMax(of_cell[cell].y, key.w);
    }
  }
}
