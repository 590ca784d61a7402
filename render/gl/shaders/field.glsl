// The lens of each direction: `LensField` of render/optics/lens_field.h, and `partLens` of
// render/splat/field_lanes-inl.h.
#ifdef FIELD
layout(std430, binding = 15) readonly buffer Field {
  vec4 field_grid;    // first node from the principal point, px; nodes a px; columns
  vec4 field_change;  // of the blur a px, and a px and dioptre; rows; radius of the lens's part
  vec4 field_part;    // its centre
  vec4 field_nodes[];  // four each: the values of `LocalLens`
};

struct LocalLens {
  mat2 p, s, f;
  vec2 c;
  vec3 coma;  // variance xx, xy, yy
};

LocalLens lensAt(vec2 offset_px) {
  ivec2 nodes = ivec2(field_grid.w, field_change.z);
  vec2 place = clamp((offset_px - field_grid.xy) * field_grid.z, vec2(0.0), vec2(nodes - 1));
  ivec2 below = min(ivec2(place), nodes - 2);
  vec2 t = place - vec2(below);
  int top = 4 * (below.y * nodes.x + below.x), bottom = top + 4 * nodes.x;
  vec4 v[4];
  for (int i = 0; i < 4; ++i) {
    v[i] = mix(mix(field_nodes[top + i], field_nodes[top + 4 + i], t.x),
               mix(field_nodes[bottom + i], field_nodes[bottom + 4 + i], t.x), t.y);
  }
  return LocalLens(mat2(v[0].xz, v[0].yw), mat2(v[1].xy, v[1].yz),
                   mat2(v[1].w, v[2].x, v[2].xy), v[2].zw, v[3].xyz);
}

mat2 powerOf(LocalLens lens) { return lens.f + mat2(focus.yz, focus.z, -focus.y); }

// The coma q(u) is this times u.
mat2 comaOf(vec2 c, vec2 u) {
  float both = c.y * u.x + c.x * u.y;
  return mat2(3.0 * c.x * u.x + c.y * u.y, both, both, 3.0 * c.y * u.y + c.x * u.x);
}

struct PartLens {
  mat2 in_focus_px, per_D_px;  // the blur is in_focus_px + off_D per_D_px
  vec2 shift_px;
};

PartLens partLens(LocalLens lens, float off_D, vec2 centre, float radius) {
  vec2 u = lens.s * centre;
  mat2 coma = comaOf(lens.c, u), power = powerOf(lens), ss = lens.s * lens.s;
  vec2 mean = lens.c * (vec2(3.0 * ss[0][0], 3.0 * ss[1][1]) + vec2(ss[1][1], ss[0][0])) +
              2.0 * lens.c.yx * ss[0][1];
  PartLens part;
  part.per_D_px = lens.p * lens.s;
  float slope = 2.0 * sqrt(max(1.0 - kComaOverlap * radius * radius, 0.0));
  part.in_focus_px = lens.p * (power + slope * coma) * lens.s;
  part.shift_px =
      lens.p * ((power + coma) * u + off_D * u - 0.25 * (1.0 - radius * radius) * mean);
  return part;
}

// Smallest and largest singular value.
vec2 stretchOf(mat2 m) {
  float plus = length(vec2(m[0][0] + m[1][1], m[0][1] - m[1][0]));
  float minus = length(vec2(m[0][0] - m[1][1], m[0][1] + m[1][0]));
  return 0.5 * vec2(abs(plus - minus), plus + minus);
}

// `LensField::blurBounds_px`.
vec2 blurBounds_px(LocalLens lens, float around_px, float point_D, float range_D) {
  mat2 per_D = lens.p * lens.s;
  float off_D = focus.x - point_D;
  vec2 stretch = stretchOf(lens.p * powerOf(lens) * lens.s + off_D * per_D);
  float change = (field_change.x + (abs(off_D) + range_D) * field_change.y) * around_px +
                 range_D * stretchOf(per_D).y;
  float coma = 2.0 * sqrt(max(lens.coma.x + lens.coma.z, 0.0));
  return vec2(max(stretch.x - change, 0.0), stretch.y + change + coma);
}
#endif

// Smallest and largest defocus: `offFocus` of render/optics/lens_field.h.
vec2 offFocus(vec2 offset_px, float around_px, float point_D, float range_D) {
#ifdef FIELD
  return blurBounds_px(lensAt(offset_px), around_px, point_D, range_D) /
         sqrt(view_px.z * view_px.w);
#else
  float off_D = abs(point_D - focus.x);
  return vec2(max(abs(off_D - focus.w) - range_D, 0.0), off_D + focus.w + range_D);
#endif
}
