// Divides squares of kMaxStep_px x kMaxStep_px cells into tiles, the largest first, until one has few
// enough samples (TileLists::chooseTiles of render/splat/bin.cpp). A tile has the index of its
// first cell. One work group a square.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Cells { uvec2 of_cell[]; };
layout(std430, binding = 1) writeonly buffer TileOfCell { uint tile_of_cell[]; };
layout(std430, binding = 2) writeonly buffer Tiles { ivec4 tiles[]; };  // x, y, side, step; px
layout(std430, binding = 3) writeonly buffer Blurs { float blur_px[]; };
shared uint log2_steps[64], blurs[64];

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), here = ivec2(gl_LocalInvocationID.xy);
  bool exists = all(lessThan(at, cells.xy));
  int cell = at.y * cells.x + at.x;
  log2_steps[gl_LocalInvocationIndex] = exists ? of_cell[cell].x : 3u;
  blurs[gl_LocalInvocationIndex] = exists ? of_cell[cell].y : 0u;
  barrier();
  if (!exists) return;
  int side = 1;
  // No tile is much larger than the image.
  while (size.w != 0 && side < min(kMaxStep_px, max(cells.x, cells.y))) side *= 2;
  for (;; side /= 2) {
    ivec2 corner = here / side * side;
    uint finest = size.w != 0 ? 3u : 0u, blur = 0u;
    for (int y = corner.y; y < corner.y + side; ++y) {
      for (int x = corner.x; x < corner.x + side; ++x) {
        finest = min(finest, log2_steps[y * 8 + x]);
        blur = max(blur, blurs[y * 8 + x]);
      }
    }
    if ((1 << finest) < side) continue;
    ivec2 first = at - here + corner;
    tile_of_cell[cell] = uint(first.y * cells.x + first.x);
    if (here == corner) {
      tiles[cell] = ivec4(at * kTile, side * kTile, 1 << finest);
      blur_px[cell] = uintBitsToFloat(blur);
    } else {
      tiles[cell] = ivec4(0);
    }
    return;
  }
}
