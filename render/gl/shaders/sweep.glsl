// Composites the splats of a tile front to back, one thread a sample: what
// render/splat/sweep_tile-inl.h does.
//
// LENS: through the whole aperture, with lens points. SUB_APERTURES: through one sub-aperture, in
// tiles where layers cover each other in part. Neither: without blur.

layout(std430, binding = 2) readonly buffer Blurs { float blur_px[]; };
layout(std430, binding = 5) readonly buffer SplatsA { vec4 splat_a[]; };
layout(std430, binding = 6) readonly buffer SplatsB { vec4 splat_b[]; };
#if defined(LENS) || defined(FIELD)
layout(std430, binding = 10) readonly buffer Lenses { vec4 lenses[]; };
#endif
#ifdef LENS
layout(std430, binding = 12) buffer Overlaps { uint overlapping[]; };  // by tile
layout(std430, binding = 13) writeonly buffer SubWork { uint sub_work[]; };
#endif
#ifdef SUB_APERTURES
layout(std430, binding = 11) readonly buffer Sharper { vec4 sharper[]; };
layout(std430, binding = 14) readonly buffer Centres { vec4 centres[]; };  // lens radii
layout(location = 0) uniform int sub_aperture;  // one a dispatch
#endif

#ifdef TRANSPARENT
shared uint see_through;
#endif
// By splat of the batch. What each holds depends on the pass.
shared vec4 form[kBatch], shape[kBatch], look[kBatch], reach[kBatch];
#ifdef LENS
shared vec4 lens_of[kBatch];
#ifdef ASTIGMATIC
shared vec4 across_of[kBatch];
#endif
#endif

float coverage;
vec2 meridian, oblong;  // of the lens, in this tile

float upToOpaque(float sum) { return max(kOpaqueWeight - sum, 0.0); }

// closingFactor of render/kernel/kernel.h; erf by Abramowitz and Stegun 7.1.26, within 1.5e-7.
float closingFactor(float blur) {
  float low_pass = background_low_pass.w;
  if (low_pass == 0.0) return 1.0;
  float x = blur / (1.41421356 * sqrt(low_pass * low_pass + 0.25 * blur * blur));
  float t = 1.0 / (1.0 + 0.3275911 * x);
  float tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t *
               (-1.453152027 + t * 1.061405429)))) * exp(-x * x);
  float inside = 1.0 - 0.5 * tail;
  return 1.0 / (inside * sqrt(inside));
}

// Adds splat `n` of the batch to one sample.
void add(uint n, vec2 at) {
  vec4 a = form[n], k = shape[n], c = look[n], z = reach[n];
  vec2 d = at - a.xy;
  float t = 1.0 - d.x * (a.z * d.x + a.w * d.y) - k.x * d.y * d.y;
  if (!(t > 0.0)) return;
  ++counted;
  if (z.x > far_m && far_m >= 0.0) {
    closeLayer(coverage);
    if (transmittance < kHidden) return;
  }
  far_m = max(far_m, z.y);

  float all = min(k.y, t * (k.w * t + k.z));
#ifdef SUB_APERTURES
  all *= z.w;
#endif
  float reaching = 1.0, opacity = abs(c.a);
  bool is_back = c.a < 0.0;
  Sums sums;
  if (is_back) sums = back_facing;
  else sums = facing;
#ifdef LENS
  vec4 lens = lens_of[n];
#ifdef ASTIGMATIC
  vec4 across = across_of[n];
  vec2 m = meridian * oblong, aside = vec2(-meridian.y, meridian.x) * oblong;
  vec2 point = vec2(lens.x * dot(d, m), across.x * dot(d, aside));
  vec2 tilt = vec2(dot(lens.zw, meridian), lens.w * meridian.x - lens.z * meridian.y);
  vec2 inv_width = vec2(lens.y, across.y);
  float n2 = square(edge.direction.x);
  float sharpness = inversesqrt(mix(1.0 / square(across.y), 1.0 / square(lens.y), n2));
#else
  vec2 point = d * lens.x * oblong, tilt = lens.zw;
  vec2 inv_width = vec2(lens.y);
  float sharpness = lens.y;
#endif
  vec2 positive = clamp(point * inv_width + 0.5, 0.0, 1.0);
  sums.lens_weight += all;
  sums.mean += all * point;
  sums.right += all * positive.x;
  sums.above += all * positive.y;
  sums.right_above += all * positive.x * positive.y;
  all *= abs(1.0 + dot(tilt, point));
  float off = edge.share - dot(edge.direction, point);
  reaching = contrast * clamp(off * sharpness + 0.5, 0.0, 1.0) + outside;
#else
  sums.mean -= all * z.z * d;
#endif
  float taken = min(all, upToOpaque(sums.weight));
  float seen = taken * reaching;
#ifdef LENS
  if (!transparent) seen = min(all * reaching, upToOpaque(sums.visible));
#endif
  sums.weight += all;
  sums.visible += seen * opacity;
  sums.colour += seen * c.rgb;
#ifdef DEPTH
  sums.distance_m += seen * 0.5 * (z.x + z.y) * opacity;
#endif
#ifdef LENS
  sums.blocked += seen * (transparent ? opacity : 1.0) * point;
#endif
  if (is_back) back_facing = sums;
  else facing = sums;
#ifdef TRANSPARENT
  float later = (all - taken) * reaching;
  if (!transparent || is_back || !(later > 0.0)) return;
  beyond += later * c.rgb;
  beyond_visible += later * opacity;
  beyond_m += later * 0.5 * (z.x + z.y) * opacity;
  if (facing.weight >= kOpaqueWeight + 1.0) closeLayer(coverage);
#endif
}

#ifdef TRANSPARENT
// Whether a splat of the tile is transparent. A node rounds its opacity.
bool anyTransparent(uvec2 entries) {
  uint me = gl_LocalInvocationIndex;
  if (me == 0u) see_through = 0u;
  barrier();
  for (uint e = entries.x + me; e < entries.y; e += kBatch) {
    if (abs(splat_b[2u * list[e].y].a) < 0.9999) atomicOr(see_through, 1u);
  }
  barrier();
  return see_through != 0u;
}
#endif

#ifdef FIELD
// `LensField::meridianAt`.
vec2 meridianOf(LocalLens lens) {
  mat2 b = lens.p * powerOf(lens) * lens.s;
  vec2 twice = vec2(b[0][0] - b[1][1], b[0][1] + b[1][0]);
  float size = length(twice);
  if (size == 0.0) return vec2(1.0, 0.0);
  if (twice.x >= 0.0) return normalize(vec2(size + twice.x, twice.y));
  return normalize(vec2(abs(twice.y), twice.y < 0.0 ? twice.x - size : size - twice.x));
}

#ifdef SUB_APERTURES
// `comaShifts_px` of render/optics/lens_field.h, of the current sub-aperture.
vec2 comaShift_px(LocalLens lens) {
  int count = int(sub_aperture_shading.z);
  vec2 mean = vec2(0.0), own = vec2(0.0);
  float squares = 0.0;
  for (int i = 0; i < count; ++i) {
    vec2 u = lens.s * centres[i].xy, shift = lens.p * (comaOf(lens.c, u) * u);
    if (i == sub_aperture) own = shift;
    mean += shift / sub_aperture_shading.z;
    squares += dot(shift, shift) / sub_aperture_shading.z;
  }
  squares -= dot(mean, mean);
  float variance = (lens.coma.x + lens.coma.z) * (1.0 - 1.0 / sub_aperture_shading.z);
  return squares > 0.0 ? sqrt(variance / squares) * (own - mean) : vec2(0.0);
}
#endif
#endif

// Composites the tile's list at one sample, as the sub-aperture at `centre` sees it.
// @param shift_px  of all splats there
void compose(uvec2 entries, vec2 at, vec2 first_px, vec2 last_px, bool exists, vec2 centre,
             vec2 shift_px) {
  clearSample();
  uint me = gl_LocalInvocationIndex;
#if defined(SUB_APERTURES) && !defined(FIELD)
#ifdef ASTIGMATIC
  vec2 along = meridian, aside = vec2(-along.y, along.x);
  vec2 px_per_D = view_px.zw * dot(centre, along) * along;
  vec2 across_px_per_D = view_px.zw * dot(centre, aside) * aside;
#else
  vec2 px_per_D = view_px.zw * centre;
#endif
#endif
  for (uint e = entries.x; e < entries.y; e += kBatch) {
    beginBatch();
    bool mine = e + me < entries.y;
    uint slot = 0u;
    vec4 a, z;
    if (mine) {
      slot = list[e + me].y;
      a = splat_a[2u * slot];
      z = splat_b[2u * slot + 1u];
#ifdef SUB_APERTURES
      vec4 k = sharper[3u * slot + 1u], off = sharper[3u * slot + 2u];
#ifdef FIELD
      a.xy += mat2(off.xy, off.zw) * centre + shift_px;
#else
      a.xy += off.x * px_per_D;
#endif
#if defined(ASTIGMATIC) && !defined(FIELD)
      a.xy += off.y * across_px_per_D;
#endif
      z = vec4(z.xy, k.zw);
#endif
      mine = all(greaterThanEqual(a.xy + z.zw, first_px)) && all(lessThanEqual(a.xy - z.zw, last_px));
    }
    if (!markBatch(mine, exists && transmittance >= kHidden)) break;
    if (mine) {
      uint n = placeInBatch();
      vec4 b = splat_a[2u * slot + 1u];
      float inv_radius = 1.0 / min(z.z, z.w);
#ifdef SUB_APERTURES
      vec4 q = sharper[3u * slot], k = sharper[3u * slot + 1u];
#ifdef FIELD
      vec2 tilt = lenses[2u * slot].zw;
#else
      vec2 tilt = sharper[3u * slot + 2u].zw;
#endif
      form[n] = vec4(a.xy, q.xy);
      shape[n] = vec4(q.zw, k.xy);
      reach[n] = vec4(z.xy, inv_radius, abs(1.0 + dot(tilt, centre)));
#else
      form[n] = a;
      shape[n] = b;
      reach[n] = vec4(z.xy, inv_radius, 0.0);
#endif
      look[n] = splat_b[2u * slot];
#ifdef LENS
#ifdef ASTIGMATIC
      lens_of[n] = lenses[2u * slot];
      across_of[n] = lenses[2u * slot + 1u];
#else
      lens_of[n] = lenses[slot];
#endif
#endif
    }
    barrier();
    uint count = batchSize();
    if (!exists) continue;
    uint n = 0u;
    for (; n < count && transmittance >= kHidden; ++n) add(n, at);
    rounds += n + 1u;
  }
  if (exists && far_m >= 0.0) closeLayer(coverage);
}

void main() {
  if (groupIndex() >= min(work[WORK_KIND], uint(room.z))) return;
  uint item = work_items[WORK_KIND * uint(room.z) + groupIndex()], index = item >> 6;
  Grid grid = gridOf(index);
  Square group = squareOf(grid, item & 63u);
  uint to = placeOf(index, group.here);
  bool exists = group.exists;
  coverage = closingFactor(blur_px[index]);
#ifdef LENS  // rampUnderBlur of render/kernel/kernel.h
  ramp = mix(vec2(kLinearToSharp, kOpaqueFromSharp), vec2(kLinearToBlurred, kOpaqueFromBlurred),
             square(min(blur_px[index] / (kRippleSteps * float(tiles[index].w)), 1.0)));
#endif
  meridian = meridian_oblong.xy;
  oblong = meridian_oblong.zw;
  vec2 shift_px = vec2(0.0);
#ifdef FIELD
  LocalLens local = lensAt(vec2(tiles[index].xy) + 0.5 * float(tiles[index].z) - view_px.xy);
  meridian = meridianOf(local);
#ifdef SUB_APERTURES
  shift_px = comaShift_px(local);
#endif
#endif
#ifdef LENS
  overlap = false;
#endif
#ifdef TRANSPARENT
  transparent = anyTransparent(grid.entries);
#endif
  vec3 background = background_low_pass.rgb;
#ifdef SUB_APERTURES
  float share = clamp((blur_px[index] - kSubAperturesFrom_px) / (kSubAperturesOnly_px - kSubAperturesFrom_px),
                      0.0, 1.0);
  float before = sub_aperture == 0 ? 1.0 - share : 1.0, each = share / sub_aperture_shading.z;
  compose(grid.entries, group.at_px, group.first_px, group.last_px, exists,
          centres[sub_aperture].xy, shift_px);
  if (exists) {
    vec4 value = vec4(light + transmittance * background, 1.0 - transmittance);
    vec4 sum = before * samples[to] + each * value;
    samples[to] = vec4(sum.rgb, min(sum.a, 1.0));  // of rounded shares
#ifdef DEPTH
    depths[to] = before * depths[to] + each * light_m;
#endif
  }
#else
  compose(grid.entries, group.at_px, group.first_px, group.last_px, exists, vec2(0.0), shift_px);
  if (exists) {
    samples[to] = vec4(light + transmittance * background, 1.0 - transmittance);
#ifdef DEPTH
    depths[to] = light_m;
#endif
  }
#endif
#ifdef LENS
  if (sub_aperture_shading.z > 1.0 && exists && overlap && blur_px[index] > kSubAperturesFrom_px &&
      overlapping[index] == 0u && atomicExchange(overlapping[index], 1u) == 0u) {
    int groups = group.groups;
    uint first = atomicAdd(work[2], uint(groups * groups));
    for (uint k = 0u; k < uint(groups * groups) && first + k < uint(room.z); ++k) {
      sub_work[2u * uint(room.z) + first + k] = index << 6 | k;
    }
    uvec4 rows = rowsOf(min(first + uint(groups * groups), uint(room.z)));
    atomicMax(sweep_groups[2].x, rows.x);
    atomicMax(sweep_groups[2].y, rows.y);
  }
#endif
  finishSquare();
}
