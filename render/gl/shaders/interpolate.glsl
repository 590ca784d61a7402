// Pixels from the samples of their tiles: copied, or by Catmull and Rom's cubic
// (render/splat/bin.cpp).
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 0) readonly buffer TileOfCell { uint tile_of_cell[]; };
layout(std430, binding = 1) readonly buffer Tiles { ivec4 tiles[]; };
layout(std430, binding = 2) readonly buffer Samples { vec4 samples[]; };
layout(std430, binding = 3) buffer Image { vec4 pixels[]; };
#ifdef DEPTH
layout(std430, binding = 4) readonly buffer Depths { float depths[]; };
layout(std430, binding = 5) buffer DepthImage { float pixel_depths[]; };
#endif
#ifdef WEIGHTS
layout(std430, binding = 6) readonly buffer Weights { float weights[]; };  // by tile
#endif

float depthOf(float weighted_m, float share) {
  return share > 0.0 ? max(weighted_m / share, 0.0) : 0.0;
}

// With WEIGHTS, over what the image holds.
void put(uint tile, int to, vec4 value, float weighted_m) {
#ifdef WEIGHTS
  float weight = weights[tile];
  if (weight == 0.0) return;
  if (weight < 1.0) {
    vec4 before = pixels[to];
    value = mix(before, value, weight);
#ifdef DEPTH
    weighted_m = mix(pixel_depths[to] * before.a, weighted_m, weight);
#endif
  }
#endif
  pixels[to] = value;
#ifdef DEPTH
  pixel_depths[to] = depthOf(weighted_m, value.a);
#endif
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, size.xy))) return;
  ivec2 cell = at / kTile;
  uint index = tile_of_cell[cell.y * cells.x + cell.x], first = index * uint(kMostSamples * kMostSamples);
  ivec4 tile = tiles[index];
  int to = at.y * size.x + at.x;
  ivec2 inside = at - tile.xy;
  if (tile.w == 1) {
    uint from = first + uint(inside.y * kMostSamples + inside.x);
#ifdef DEPTH
    put(index, to, samples[from], depths[from]);
#else
    put(index, to, samples[from], 0.0);
#endif
    return;
  }
  vec2 place = (vec2(inside) + 0.5) / float(tile.w) - 0.5 + float(kApron);
  ivec2 below = ivec2(place);
  vec4 tx = catmullRom(place.x - float(below.x)), ty = catmullRom(place.y - float(below.y));
  vec4 value = vec4(0.0);
  float weighted_m = 0.0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      uint from = first + uint((below.y - 1 + y) * kMostSamples + below.x - 1 + x);
      value += tx[x] * ty[y] * samples[from];
#ifdef DEPTH
      weighted_m += tx[x] * ty[y] * depths[from];
#endif
    }
  }
  value.a = clamp(value.a, 0.0, 1.0);
  put(index, to, value, weighted_m);
}
