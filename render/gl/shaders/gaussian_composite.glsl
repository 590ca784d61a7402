// Composites the Gaussians of a tile front to back, as one disc of the lens sees them, one thread a
// sample: what render/gaussians/composite_tile-inl.h does. One dispatch adds the `disc`-th disc of each tile to the tile's mean.

// By tile: first disc, number, first of its samples that are followed.
layout(std430, binding = 2) readonly buffer Lenses { uvec4 lens_of[]; };
layout(std430, binding = 5) readonly buffer ProjectedA { vec4 projected_a[]; };
layout(std430, binding = 6) readonly buffer ProjectedB { vec4 projected_b[]; };
// Two vectors each: centre and radius, lens radii, and five polynomials (`polynomialsOver`).
layout(std430, binding = 10) readonly buffer Discs { vec4 discs[]; };
#ifdef FOLLOW
// Seven vectors each: light of the first view, then of all views less that the sums and the sums of
// products: red; green, blue, rr, rg; rb, gg, gb, bb; the sums times each polynomial; the number.
layout(std430, binding = 11) buffer Follows { vec4 followed[]; };
#endif

layout(location = 0) uniform uint disc;
layout(location = 1) uniform vec3 background;  // display values

const float kMaxAlpha = 0.99, kOpaque = 1e-4;
const float kLog2E = 1.44269504, kMaxExponent = 60.0;

// By Gaussian of the batch: centre, qa, qb; qc, end, peak, distance; colour.
shared vec4 form[kBatch], shape[kBatch];
shared vec3 look[kBatch];

// As the disc sees a Gaussian. At the offset d from its centre, pixels,
//   alpha = peak 2^-q,  q = qa dx^2 + qb dx dy + qc dy^2,  where q < end.
struct Seen {
  vec4 form, shape;
  vec2 reach_px;
};

Seen see(uint slot, vec3 lens) {
  vec4 a = projected_a[2u * slot], b = projected_a[2u * slot + 1u], c = projected_b[2u * slot];
  vec2 radius = view_px.zw, p = lens.xy, shear = radius * p, j = focus.yz, s = b.yz;
  float off = c.x, e = b.w;
  vec2 aside = radius * vec2(j.x * p.x + j.y * p.y, j.y * p.x - j.x * p.y);
  vec2 at = a.xy + off * shear + aside;

  // The sheared Gaussian.
  float xx = a.z - 2.0 * shear.x * s.x + shear.x * shear.x * e;
  float yy = b.x - 2.0 * shear.y * s.y + shear.y * shear.y * e;
  float xy = a.w - shear.x * s.y - shear.y * s.x + shear.x * shear.y * e;
  const float least = kLowPass_px2 * kLowPass_px2;  // that of a point
  float sharp = max(xx * yy - xy * xy, least);

  // The disc's variance, also over the depth of the Gaussian.
  float variance = kDisc * lens.z * lens.z;
  xx += variance * radius.x * radius.x * (e + square(off + j.x) + j.y * j.y);
  yy += variance * radius.y * radius.y * (e + square(off - j.x) + j.y * j.y);
  xy += 2.0 * variance * radius.x * radius.y * j.y * off;
  float blurred = max(xx * yy - xy * xy, least);

  float scale = 0.5 * kLog2E / blurred;
  float opacity = c.y * sqrt(sharp / blurred), above = (opacity - 1.0) * kLog2E;
  float peak = above > 0.0 ? exp2(min(above, kMaxExponent)) : opacity;
  return Seen(vec4(at, yy * scale, -2.0 * xy * scale),
              vec4(xx * scale, 0.5 * kLog2E * c.z, peak, c.w), sqrt(c.z * vec2(xx, yy)));
}

vec3 linearOf(vec3 display) {
  vec3 s = clamp(display, 0.0, 1.0);
  return mix(pow((s + 0.055) / 1.055, vec3(2.4)), s / 12.92, lessThanEqual(s, vec3(0.04045)));
}

#ifdef FOLLOW
// The samples that `ViewSpread::begin` follows.
// @param own  the disc's vectors
void follow(uint from, ivec2 here, int side, int apron, uint views, vec4 own[2], vec3 light) {
  int apart = apron > 0 ? 2 : 4, first = apron + apart / 2;
  ivec2 step_ = (here - first) / apart;
  if (any(lessThan(here, ivec2(first))) || any(greaterThanEqual(here, ivec2(side - apron))) ||
      first + step_ * apart != here) {
    return;
  }
  int along = (side - apron - first + apart - 1) / apart;
  uint at = 7u * (from + uint(step_.y * along + step_.x));
  if (disc == 0u) {
    followed[at] = vec4(light, 0.0);
    for (uint i = 1u; i < 6u; ++i) followed[at + i] = vec4(0.0);
    followed[at + 6u] = vec4(0.0, 0.0, 0.0, float(views));
    return;
  }
  vec3 d = light - followed[at].rgb;
  followed[at].w += d.r;
  followed[at + 1u] += vec4(d.g, d.b, d.r * d.r, d.r * d.g);
  followed[at + 2u] += vec4(d.r * d.b, d.g * d.g, d.g * d.b, d.b * d.b);
  vec4 p = own[1];
  followed[at + 3u] += vec4(own[0].w * d, p.x * d.r);
  followed[at + 4u] += vec4(p.x * d.gb, p.y * d.rg);
  followed[at + 5u] += vec4(p.y * d.b, p.z * d);
  followed[at + 6u] += vec4(p.w * d, 0.0);
}
#endif

void main() {
  Square group = squareOf(work_items[gl_WorkGroupID.x]);
  uvec4 lenses = lens_of[group.tile];
  if (disc >= lenses.y) return;
  vec4 own[2] = vec4[2](discs[2u * (lenses.x + disc)], discs[2u * (lenses.x + disc) + 1u]);
  vec3 lens = own[0].xyz;
  float through = group.exists ? 1.0 : 0.0, weighted_m = 0.0;
  vec3 display = vec3(0.0);
  for (uint e = group.entries.x; e < group.entries.y; e += kBatch) {
    beginBatch();
    uint entry = e + gl_LocalInvocationIndex, slot = 0u;
    bool mine = entry < group.entries.y;
    Seen seen;
    if (mine) {
      slot = list[entry].y;
      seen = see(slot, lens);
      mine = all(greaterThanEqual(seen.form.xy + seen.reach_px, group.first_px)) &&
             all(lessThanEqual(seen.form.xy - seen.reach_px, group.last_px));
    }
    if (!markBatch(mine, through > kOpaque)) break;
    if (mine) {
      uint n = placeInBatch();
      form[n] = seen.form;
      shape[n] = seen.shape;
      look[n] = projected_b[2u * slot + 1u].rgb;
    }
    barrier();
    uint count = batchSize(), n = 0u;
    for (; n < count && through > kOpaque; ++n) {
      vec4 a = form[n], k = shape[n];
      vec2 d = group.at_px - a.xy;
      float q = (a.z * d.x + a.w * d.y) * d.x + k.x * d.y * d.y;
      if (!(q < k.y)) continue;
      ++counted;
      float taken = through * min(k.z * exp2(-max(q, 0.0)), kMaxAlpha);
      through -= taken;
      display += taken * look[n];
      weighted_m += taken * k.w;
    }
    rounds += n + 1u;
  }

  if (group.exists) {
    float share = 1.0 / float(lenses.y);
    vec3 light = linearOf(display + through * background);
    vec4 value = share * vec4(light, 1.0 - through);
    uint to = group.to;
    samples[to] = disc == 0u ? value : samples[to] + value;
#ifdef DEPTH
    depths[to] = disc == 0u ? share * weighted_m : depths[to] + share * weighted_m;
#endif
#ifdef FOLLOW
    follow(lenses.z, group.here, group.side, tiles[group.tile].w > 1 ? kApron : 0, lenses.y, own, light);
#endif
  }
  finishSquare();
}
