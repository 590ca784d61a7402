// How blurred the Gaussians of each tile are: `blurOf` of render/gaussians/tile_layers.h. With
// LISTED, also each entry of the lists: `ListedGaussian` there. One work group a tile.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Lists { uvec2 list[]; };
layout(std430, binding = 1) readonly buffer Ranges { uvec2 range[]; };
layout(std430, binding = 2) readonly buffer Keys { uvec4 keys[]; };
layout(std430, binding = 3) readonly buffer ProjectedB { vec4 projected_b[]; };
layout(std430, binding = 4) writeonly buffer Blurs { float radius_px[]; };
#ifdef LISTED
// The blur radius, px; the opacity, of which the last two bits are the logarithm of the step.
layout(std430, binding = 5) writeonly buffer Listed { uvec2 listed[]; };
#endif
shared vec2 sums[64];  // of fourth powers, of weights

void main() {
  uint tile = groupIndex(), me = gl_LocalInvocationID.x;
  if (tile >= uint(cells.x * cells.y)) return;
  vec2 sum = vec2(0.0);
  for (uint e = range[tile].x + me; e < range[tile].y; e += 64u) {
    uint slot = list[e].y;
    vec4 own = projected_b[2u * slot];
    float peak = min(own.y, 1.0);
#ifdef LISTED
    uint log2_step = own.x > 0.0 ? keys[slot].y >> 30 : 0u;
    listed[e] = uvec2(keys[slot].w, (floatBitsToUint(own.y) & ~3u) | log2_step);
#endif
    sum += peak * vec2(square(square(uintBitsToFloat(keys[slot].w))), 1.0);
  }
  sums[me] = sum;
  for (uint half_ = 32u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (me < half_) sums[me] += sums[me + half_];
  }
  if (me == 0u) radius_px[tile] = sums[0].y > 0.0 ? sqrt(sqrt(sums[0].x / sums[0].y)) : 0.0;
}
