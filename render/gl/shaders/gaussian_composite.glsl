// Composites the Gaussians of a tile front to back, as one disc of the lens sees them, one thread a
// sample: what render/gaussians/composite_tile-inl.h does. One dispatch adds the `disc`-th disc of
// each tile to the tile's mean. With JOBS, each job has discs of its own, and may be one of several
// layers; with BEHIND, one behind another. With JUDGE, samples are followed, and not shown.

layout(std430, binding = 5) readonly buffer ProjectedA { vec4 projected_a[]; };
layout(std430, binding = 6) readonly buffer ProjectedB { vec4 projected_b[]; };
// Two vectors each: centre and radius, lens radii, and five polynomials (`polynomialsOver`).
layout(std430, binding = 10) readonly buffer Discs { vec4 discs[]; };
layout(location = 0) uniform uint disc;
layout(location = 1) uniform vec3 background;  // display values
#ifdef JOBS
layout(location = 2) uniform uvec2 items;  // first, number
#else
layout(location = 2) uniform uint disc_count;
#endif

const float kLog2E = 1.44269504;

// By Gaussian of the batch: centre, qa, qb; qc, end, peak, distance; colour.
shared vec4 form[kBatch], shape[kBatch];
shared vec3 look[kBatch];
#ifdef DEPTH
shared vec4 vergences[kBatch];  // slope, low, high: `Vergences` of render/gaussians/lane_functions-inl.h
#endif

// As the disc sees a Gaussian. At the offset d from its centre, pixels,
//   alpha = peak 2^-q,  q = qa dx^2 + qb dx dy + qc dy^2,  where q < end.
struct Seen {
  vec4 form, shape, vergence;
  vec2 reach_px;
};

Seen see(uint slot, vec3 lens) {
  vec4 a = projected_a[2u * slot], b = projected_a[2u * slot + 1u], c = projected_b[2u * slot];
  vec2 radius = view_px.zw, p = lens.xy, shear = radius * p, j = focus.yz, s = b.yz;
  float off = c.x, e = b.w;
  vec2 aside = radius * vec2(j.x * p.x + j.y * p.y, j.y * p.x - j.x * p.y);
  vec2 moved = off * shear + aside;
#ifdef FIELD
  LocalLens local = lensAt(a.xy - view_px.xy);
  PartLens part = partLens(local, off, p, lens.z);
  moved = part.shift_px;
  shear = part.per_D_px * p;
#endif
  vec2 at = a.xy + moved;

  // The sheared Gaussian.
  float xx = a.z - 2.0 * shear.x * s.x + shear.x * shear.x * e;
  float yy = b.x - 2.0 * shear.y * s.y + shear.y * shear.y * e;
  float xy = a.w - shear.x * s.y - shear.y * s.x + shear.x * shear.y * e;
  const float least = kLowPass_px2 * kLowPass_px2;  // that of a point
  float sharp = max(xx * yy - xy * xy, least);

  // The disc's variance, also over the depth of the Gaussian.
  float variance = kDisc * lens.z * lens.z;
#ifdef FIELD
  mat2 moves = part.in_focus_px + off * part.per_D_px, per_D = part.per_D_px;
  mat2 blur = variance * (moves * transpose(moves) + e * (per_D * transpose(per_D)));
  vec3 coma = square(lens.z * lens.z) * local.coma;
  xx += blur[0][0] + coma.x;
  yy += blur[1][1] + coma.z;
  xy += blur[0][1] + coma.y;
#else
  xx += variance * radius.x * radius.x * (e + square(off + j.x) + j.y * j.y);
  yy += variance * radius.y * radius.y * (e + square(off - j.x) + j.y * j.y);
  xy += 2.0 * variance * radius.x * radius.y * j.y * off;
#endif
  float blurred = max(xx * yy - xy * xy, least);

  vec4 vergence = vec4(0.0);
#ifdef DEPTH
  vec2 t = s - e * shear;
  float middle = 1.0 / c.w, high = middle + kVergenceReach * sqrt(e);
  vergence = vec4(vec2(yy * t.x - xy * t.y, xx * t.y - xy * t.x) / blurred,
               middle * middle / high, high);
#endif

  float scale = 0.5 * kLog2E / blurred;
  float opacity = c.y * sqrt(sharp / blurred), above = (opacity - 1.0) * kLog2E;
  float peak = above > 0.0 ? exp2(min(above, kMaxPeakExponent)) : opacity;
  return Seen(vec4(at, yy * scale, -2.0 * xy * scale),
              vec4(xx * scale, 0.5 * kLog2E * c.z, peak, c.w), vergence, sqrt(c.z * vec2(xx, yy)));
}

void main() {
#ifdef JOBS
  if (groupIndex() >= items.y) return;
  uint item = work_items[items.x + groupIndex()];
  Job job = jobs[item >> 6];
  if (disc >= job.discs.y) return;
  Grid grid = Grid(job.first_px, job.step_px, job.side, job.entries);
  uint own = 2u * (job.discs.x + disc), disc_count = job.discs.y;
#else
  if (groupIndex() >= min(work[0], uint(room.z))) return;
  uint item = work_items[groupIndex()], own = 2u * disc;
  Grid grid = gridOf(item >> 6);
#endif
  Square group = squareOf(grid, item & 63u);
  vec3 lens = discs[own].xyz;
  float through = group.exists ? 1.0 : 0.0, weighted_m = 0.0;
  vec3 display = vec3(0.0);
  for (uint e = grid.entries.x; e < grid.entries.y; e += kBatch) {
    beginBatch();
    uint entry = e + gl_LocalInvocationIndex, slot = 0u;
    bool mine = entry < grid.entries.y;
    Seen seen;
    if (mine) {
      slot = list[entry].y;
      seen = see(slot, lens);
      mine = all(greaterThanEqual(seen.form.xy + seen.reach_px, group.first_px)) &&
             all(lessThanEqual(seen.form.xy - seen.reach_px, group.last_px));
    }
    if (!markBatch(mine, through > kOpaqueTransmittance)) break;
    if (mine) {
      uint n = placeInBatch();
      form[n] = seen.form;
      shape[n] = seen.shape;
      look[n] = projected_b[2u * slot + 1u].rgb;
#ifdef DEPTH
      vergences[n] = seen.vergence;
#endif
    }
    barrier();
    uint count = batchSize(), n = 0u;
    for (; n < count && through > kOpaqueTransmittance; ++n) {
      vec4 a = form[n], k = shape[n];
      vec2 d = group.at_px - a.xy;
      float q = (a.z * d.x + a.w * d.y) * d.x + k.x * d.y * d.y;
      if (!(q < k.y)) continue;
      ++counted;
      float taken = through * min(k.z * exp2(-max(q, 0.0)), kMaxAlphaOfGaussian);
      through -= taken;
      display += taken * look[n];
#ifdef DEPTH
      vec4 v = vergences[n];
      weighted_m += taken / clamp(1.0 / k.w + dot(v.xy, d), v.z, v.w);
#endif
    }
    rounds += n + 1u;
  }

  if (group.exists) {
    Light behind = Light(vec4(background, 0.0), vec4(0.0));
#ifdef JOBS
    if (job.behind != kNone && through > kOpaqueTransmittance) {
      uint plane = 2u * uint(job.behind_side * job.behind_side);
      behind = lightBehind(job, group.here, job.behind + disc * plane);
    }
#endif
#ifdef FOLLOW
    follow(job, group.here, disc, vec4[2](discs[own], discs[own + 1u]), vec4(display, through),
           background);
#endif
#ifndef JUDGE
    display += through * behind.display.rgb;
    vec3 light = linearOf(display) + through * through * behind.light.rgb;
    float covered = 1.0 - through + through * behind.display.a;
    weighted_m += through * behind.light.a;
#ifdef BEHIND
    addToFronts(job, group.here, disc, Light(vec4(display, covered), vec4(light, weighted_m)));
#else
    float share = 1.0 / float(disc_count);
#ifdef JOBS
    uint to = job.to + uint(group.here.y * kMostSamples + group.here.x);
#else
    uint to = placeOf(item >> 6, group.here);
#endif
    vec4 value = share * vec4(light, covered);
    samples[to] = disc == 0u ? value : samples[to] + value;
#ifdef DEPTH
    depths[to] = disc == 0u ? share * weighted_m : depths[to] + share * weighted_m;
#endif
#endif
#endif
  }
  finishSquare();
}
