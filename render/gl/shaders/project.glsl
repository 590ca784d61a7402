// Projects the surfels and nodes of the cut to splats: what render/splat/project_lanes-inl.h and
// finish_splats-inl.h do. One thread an entry.

layout(std430, binding = 0) readonly buffer Entries { uvec2 entries[]; };
layout(std430, binding = 1) readonly buffer NodePlaces { vec4 node_place[]; };
// Three a node, as bits: packed integers are no floats, which a device may flush to zero.
layout(std430, binding = 2) readonly buffer Nodes { uvec4 node[]; };
// Two vectors a surfel and a splat in each; apart, because drivers limit the size of a buffer.
layout(std430, binding = 3) readonly buffer SurfelsA { vec4 surfel_a[]; };
layout(std430, binding = 10) readonly buffer SurfelsB { vec4 surfel_b[]; };
layout(std430, binding = 4) writeonly buffer SplatsA { vec4 splat_a[]; };
layout(std430, binding = 11) writeonly buffer SplatsB { vec4 splat_b[]; };
layout(std430, binding = 6) readonly buffer Shapes { vec4 shapes[]; };
#ifdef LENS
layout(std430, binding = 8) writeonly buffer Lenses { vec4 lenses[]; };  // ASTIGMATIC: two a splat
#endif
#ifdef SUB_APERTURES
layout(std430, binding = 9) writeonly buffer Sharper { vec4 sharper[]; };  // three a splat
#endif
#ifdef BODIES
layout(std430, binding = 12) readonly buffer Outside { uint outside[]; };  // by body
layout(std430, binding = 13) readonly buffer AllFacing { uint facing[]; };
#endif

// Of `node` and the surfels the shader sees a window: first node, number, first surfel, number.
layout(location = 0) uniform uvec4 window;

struct Footprint {
  float vxx, vxy, vyy, area, along2, thick2, widest2, own;
  vec3 normal, slant;
};
struct Lane {
  vec2 at;
  float vxx, vxy, vyy, prefilter;
  vec2 blur2;
  float blur_xy, blur_min2, radius, narrow, unblurred, added, off_D, across_D;
  vec2 tilt;
  float area, distance_m, reach, shade, away;
};
struct Kernel {
  vec3 q, k;
  vec2 extent;
  bool sound;
};

// @param i  within the window
Footprint nodeFootprint(uint i, vec3 p, vec3 to_x, vec3 to_y, vec3 to_distance) {
  vec4 a = uintBitsToFloat(node[3u * i]);
  vec3 b = uintBitsToFloat(node[3u * i + 1u].xyz);
  mat3 v = mat3(a.x, a.y, a.z, a.y, a.w, b.x, a.z, b.x, b.y);
  vec3 vx = v * to_x;
  Footprint f;
  f.vxx = dot(to_x, vx);
  f.vxy = dot(to_y, vx);
  f.vyy = dot(to_y, v * to_y);
  f.area = b.z * sqrt(max(f.vxx * f.vyy - f.vxy * f.vxy, 0.0));
  f.along2 = dot(to_distance, v * to_distance);
  f.own = float(node[3u * i + 1u].w >> 16) * (1.0 / 65535.0);
  f.widest2 = f.own * (a.x + a.w + b.y);
  f.thick2 = 0.5 * f.widest2;
  f.normal = unpackNormal(node[3u * i + 2u].w);
  mat3 adjugate = mat3(cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1]));
  vec3 q = adjugate * p;
  float trace = adjugate[0].x + adjugate[1].y + adjugate[2].z;
  float least = dot(p, p) * (kLeastCos2 * trace + kRounding * square(a.x + a.w + b.y));
  f.slant = q / max(dot(q, p), max(least, 1e-36));
  return f;
}

// @param i  within the window
Footprint surfelFootprint(uint i, vec3 p, vec3 to_x, vec3 to_y, vec3 to_distance) {
  vec4 b = surfel_a[2u * i + 1u], c = surfel_b[2u * i];
  vec3 u = b.xyz, v = c.xyz;
  float ux = dot(to_x, u), uy = dot(to_y, u), vx = dot(to_x, v), vy = dot(to_y, v);
  float inv = 1.0 / sqrt(dot(u, u) * dot(v, v));
  Footprint f;
  f.vxx = ux * ux + vx * vx;
  f.vyy = uy * uy + vy * vy;
  f.vxy = ux * uy + vx * vy;
  f.area = b.w * abs(ux * vy - uy * vx) * inv;
  f.along2 = square(dot(to_distance, u)) + square(dot(to_distance, v));
  f.thick2 = f.widest2 = max(dot(u, u), dot(v, v));
  f.own = 1.0;
  f.normal = cross(u, v) * inv;
  float towards = dot(f.normal, p);
  f.slant = f.normal / (towards < 0.0 ? min(towards, -1e-20) : max(towards, 1e-20));
  return f;
}

void blurRound(inout Lane lane, Footprint f, float soft) {
  vec2 c = blur_lens.xy * abs(lane.off_D);
  lane.blur2 = kDisc * c * c;
  lane.blur_xy = 0.0;
  lane.blur_min2 = min(lane.blur2.x, lane.blur2.y);
  lane.radius = sqrt(c.x * c.y);
  float wide = (soft * f.vxx + lane.prefilter) * (soft * f.vyy + lane.prefilter);
  lane.narrow = sqrt(max(wide - square(soft * f.vxy), 0.0)) / max(c.x * c.y, 1e-12);
  lane.unblurred = 0.0;
  lane.across_D = lane.off_D;
}

// `narrowOfEllipse` of project_lanes-inl.h, of a lane with its blur.
void narrowEllipse(inout Lane lane, Footprint f, float soft) {
  float sxx = soft * f.vxx + lane.prefilter, sxy = soft * f.vxy;
  float syy = soft * f.vyy + lane.prefilter;
  float bxx = lane.blur2.x, bxy = lane.blur_xy, byy = lane.blur2.y;
  lane.unblurred = sqrt(max(sxx * syy - sxy * sxy, 0.0));
  float wxx = sxx + bxx, wxy = sxy + bxy, wyy = syy + byy;
  float inv_det = 1.0 / (wxx * wyy - wxy * wxy);
  float sum = inv_det * (wxx * byy + wyy * bxx - 2.0 * wxy * bxy);
  float product = inv_det * (bxx * byy - bxy * bxy);
  float moment2 = 0.375 * sum * sum - 0.5 * product;
  float longer = 0.5 * (sum + sqrt(max(sum * sum - 4.0 * product, 0.0)));
  float share = sqrt(max(kLongAxis * longer * longer + (1.0 - kLongAxis) * moment2, 1e-12));
  lane.narrow = max(kDisc * (1.0 / share - 1.0), 0.0);
}

#ifdef FIELD
// `blurOfField` of project_lanes-inl.h.
void blurOfField(inout Lane lane, Footprint f, float soft, LocalLens local, PartLens part) {
  float radius2 = square(field_change.w);
  mat2 b = part.in_focus_px + lane.off_D * part.per_D_px;
  mat2 variance = kDisc * radius2 * b * transpose(b);
  vec3 blur = vec3(variance[0], variance[1].y) + square(radius2) * local.coma;
  lane.blur2 = blur.xz;
  lane.blur_xy = blur.y;
  float middle = 0.5 * (blur.x + blur.z), apart = length(vec2(0.5 * (blur.x - blur.z), blur.y));
  lane.blur_min2 = max(middle - apart, 0.0);
  lane.radius = sqrt(middle / kDisc);
  mat2 m = part.in_focus_px;
  vec2 meridian = vec2(m[0][0] - m[1][1], m[0][1] + m[1][0]);
  float along = dot(vec2(b[0][0] - b[1][1], b[0][1] + b[1][0]), meridian) /
                max(length(meridian), 1e-12);
  float trace = b[0][0] + b[1][1];
  float per_D = 0.5 * field_change.w / sqrt(max(blur_lens.x * blur_lens.y, 1e-30));
  lane.off_D = per_D * (trace + along);
  lane.across_D = per_D * (trace - along);
  narrowEllipse(lane, f, soft);
}
#endif

void blurEllipse(inout Lane lane, Footprint f, float soft) {
  float j45 = focus.z, fx = lane.off_D + focus.y, fy = lane.off_D - focus.y;
  float bxx = kDisc * blur_lens.x * blur_lens.x * (fx * fx + j45 * j45);
  float byy = kDisc * blur_lens.y * blur_lens.y * (fy * fy + j45 * j45);
  float bxy = 2.0 * kDisc * blur_lens.x * blur_lens.y * j45 * lane.off_D;
  float mean_D = abs(lane.off_D), off_D = lane.off_D;
  float narrowest = min(blur_lens.x, blur_lens.y);
  lane.blur2 = vec2(bxx, byy);
  lane.blur_xy = bxy;
  lane.blur_min2 = kDisc * square(narrowest * (mean_D - focus.w));
  lane.radius = sqrt(blur_lens.x * blur_lens.y) * (mean_D + focus.w);
  lane.off_D = off_D + focus.w;
  lane.across_D = off_D - focus.w;
  narrowEllipse(lane, f, soft);
}

const float kSteps = float(kKernelShapes - 1);

Kernel kernelOf(Lane lane, float widen, float blur, float weight) {
  float t = lane.narrow / max(blur, 1e-12), n = 24.0 * t * (1.0 + 2.0 * t);
  vec4 shape = shapes[n < kMaxExponent ? int(sqrt(max(n, 0.0) * (1.0 / kMaxExponent)) * kSteps + 0.5) : int(kSteps)];
  vec2 own = vec2(lane.vxx, lane.vyy) - lane.prefilter;
  vec2 r = shape.w * (lane.prefilter + widen * own + blur * lane.blur2);
  float rxy = shape.w * (widen * lane.vxy + blur * lane.blur_xy);
  float det = r.x * r.y - rxy * rxy;
  Kernel kernel;
  kernel.sound = det > 0.0;
  kernel.extent = sqrt(r);
  float inv_det = 1.0 / det;
  kernel.q = vec3(r.y, -2.0 * rxy, r.x) * inv_det;
  kernel.k = shape.xyz * (weight * lane.area * sqrt(inv_det));
  return kernel;
}

bool touches(vec2 at, vec2 reach) {
  float margin = float(size.z);
  return all(greaterThan(at + reach, vec2(-margin))) &&
         all(lessThan(at - reach, vec2(size.xy) + margin));
}

// `reachesImage` of project_lanes-inl.h.
// @param axis   of the view on the image, as the aperture's centre sees it
// @param reach  of the surfel, over its depth
bool reachesImage(vec2 at, vec2 axis, float reach, vec2 soft) {
  vec2 beyond = float(size.z) + sqrt(kWidestSupport2 * soft);
  vec2 edge = max(abs(axis + beyond), abs(vec2(size.xy) - axis + beyond));
  vec2 focal = focal_principal_px.xy;
  vec2 reach_px = reach * sqrt(edge * edge + focal * focal) + beyond;
  return all(greaterThan(at + reach_px, vec2(0.0))) && all(lessThan(at - reach_px, vec2(size.xy)));
}

#ifdef LENS
vec4 lensOf(Lane lane, float radius, float variance, float off_D) {
  float blur = kDisc * radius * radius;
  float smear = clamp(variance - lane.prefilter, 0.0, blur);
  float lens = blur + smear, random = variance - smear;
  float per_px = sqrt(kDisc * lens) / (lens + random);
  return vec4(off_D < 0.0 ? -per_px : per_px, sqrt((lens + random) / (3.0 * max(random, 1e-12))),
              lane.tilt);
}
#endif

uint stepOf(Lane lane, Kernel kernel, vec3 colour) {
  float brightest = max(max(colour.r, colour.g), colour.b);
  float peak = kernel.k.x * brightest * clamp(brightest, 1.0, kLight);
  float highlight = clamp((peak - kHighlight) / kHighlight, 0.0, 1.0);
  float all2 = lane.prefilter + lane.blur_min2, by_acuity = (lane.prefilter - 1.0) / all2;
  float sharpness = 1.0 - kFiner * highlight;
  float sigma = sqrt(all2) * (sharpness + by_acuity * (kCoarser - sharpness));
  return log2StepFor(sigma);
}

void projectEntry(uint slot) {
#ifdef CUT
  uint index = entries[slot].x;
  float weight = uintBitsToFloat(entries[slot].y);
  bool is_node = slot < cut_nodes;
#else
  uint index = slot;
  float weight = 1.0;
  const bool is_node = false;
#endif
  uint i = index - (is_node ? window.x : window.z);  // wraps around before the window
  if (i >= (is_node ? window.y : window.w)) return;
  writeNoKey(slot);
  vec3 p = is_node ? node_place[index].xyz : surfel_a[2u * i].xyz;
  bool along_axis = scene.z != 0;
  vec3 eye = vec3(right.w, up.w, back.w);
  p -= eye;
  float depth = -dot(back.xyz, p), near_m = cut.w;
  if (depth < near_m) return;
  float inv_depth = 1.0 / max(depth, near_m);
  vec2 tangent = vec2(dot(right.xyz, p), dot(up.xyz, p)) * inv_depth;
  vec2 focal = focal_principal_px.xy;
  float sight2 = dot(p, p), inv_sight = 1.0 / sqrt(sight2);
  Lane lane;
  lane.distance_m = along_axis ? depth : sight2 * inv_sight;
  float inv_distance = along_axis ? 1.0 / depth : inv_sight;
  float from_focus_D = focus.x - inv_distance;
  lane.off_D = from_focus_D;
  vec2 axis = focal_principal_px.zw + blur_lens.zw * lane.off_D, per_D_px = blur_lens.zw;
#ifdef FIELD
  LocalLens local = lensAt(vec2(focal.x, -focal.y) * tangent);
  PartLens part = partLens(local, lane.off_D, field_part.xy, field_change.w);
  axis += part.shift_px;
  per_D_px = part.per_D_px * field_part.xy;
#endif
  lane.at = axis + vec2(focal.x, -focal.y) * tangent;
  vec3 along = along_axis ? -back.xyz : p * inv_sight;
  vec2 slope = per_D_px * (inv_distance * inv_distance);
  vec3 to_x = slope.x * along + focal.x * inv_depth * (back.xyz * tangent.x + right.xyz);
  vec3 to_y = slope.y * along - focal.y * inv_depth * (back.xyz * tangent.y + up.xyz);

  Footprint f = is_node ? nodeFootprint(i, p, to_x, to_y, along)
                        : surfelFootprint(i, p, to_x, to_y, along);
  lane.reach = sqrt(kReach2 * f.along2 + f.thick2);
  lane.prefilter = square(max(acuity.w * length(lane.at - acuity.xy) + acuity.z, 1.0));
  float soft = (kOverlap - 1.0) * (1.0 - f.own) + 1.0;
#ifdef FIELD
  blurOfField(lane, f, soft, local, part);
#elif defined(ASTIGMATIC)
  blurEllipse(lane, f, soft);
#else
  blurRound(lane, f, soft);
#endif
  lane.vxx = f.own * f.vxx + lane.prefilter;
  lane.vyy = f.own * f.vyy + lane.prefilter;
  lane.vxy = f.own * f.vxy;
  lane.added = 0.5 * (1.0 - f.own) * (f.vxx + f.vyy);
  lane.area = f.area;
  vec2 variance = vec2(lane.vxx, lane.vyy) + lane.blur2;
  if (!(touches(lane.at, sqrt(kWidestSupport2 * variance)) && f.area > 0.0 && f.area < kLargest_px2 &&
        variance.x < kLargest_px2 && variance.y < kLargest_px2)) {
    return;
  }
  float reach = sqrt(kWidestSupport2 * f.widest2) * inv_depth;
  if (!reachesImage(lane.at, axis, reach, lane.prefilter + lane.blur2)) return;

  float towards = dot(f.normal, p);
#ifdef BODIES
  uint body = is_node ? facing[index] & 0xFFFFu : uint(surfel_b[2u * i].w);
  bool both_sides = is_node && facing[index] >> 16 == 0u;
  bool from_outside = body != kSeveral && outside[body] != 0u;
  if (from_outside && !both_sides) {
    if (towards > sub_aperture_shading.w) return;
    float off2 = square(from_focus_D) + dot(focus.yz, focus.yz);
    weight *= 1.0 + kFrontCover / (1.0 + view_px.z * view_px.w * off2);
  }
#endif
  lane.away = towards * inv_sight;
#ifdef BODIES
  // A node that holds both sides counts as a front: the mean of its normals may face away.
  if (from_outside && both_sides) lane.away = -abs(lane.away);
#endif
  vec2 tilt = vec2(-blur_lens.x / focal.x * dot(right.xyz, f.slant),
                   blur_lens.y / focal.y * dot(up.xyz, f.slant));
  float steep = length(tilt);
  lane.tilt = tilt * (max(steep - kMinTilt, 0.0) / max(steep, kMinTilt));
  lane.shade = sub_aperture_shading.y * (abs(lane.away) - 1.0) + 1.0;

  Kernel kernel = kernelOf(lane, 1.0, 1.0, weight);
  if (!kernel.sound || !touches(lane.at, kernel.extent)) return;
  vec4 look = is_node ? vec4(uintBitsToFloat(node[3u * i + 2u].xyz),
                             float(node[3u * i + 1u].w & 0xFFFFu) * (1.0 / 65535.0))
                      : vec4(surfel_b[2u * i + 1u].xyz, surfel_a[2u * i].w);
  vec3 colour = lane.shade * look.a * look.rgb;
  bool is_back = cells.w != 0 && lane.away > 0.0;
  splat_a[2u * slot] = vec4(lane.at, kernel.q.xy);
  splat_a[2u * slot + 1u] = vec4(kernel.q.z, kernel.k);
  splat_b[2u * slot] = vec4(colour, is_back ? -look.a : look.a);
  splat_b[2u * slot + 1u] = vec4(max(lane.distance_m - lane.reach, 0.0),
                               lane.distance_m + lane.reach, kernel.extent);
  uvec2 low = uvec2(clamp(lane.at - kernel.extent - 0.5, vec2(0.0), vec2(size.xy) - 1.0));
  uvec2 high = uvec2(clamp(lane.at + kernel.extent - 0.5, vec2(0.0), vec2(size.xy) - 1.0));
  writeKey(slot, lane.distance_m, low, high, stepOf(lane, kernel, colour), lane.radius);

#ifdef LENS
#ifdef ASTIGMATIC
  float scale = sqrt(blur_lens.x * blur_lens.y);
  lenses[2u * slot] = lensOf(lane, scale * lane.off_D, lane.unblurred, lane.off_D);
  lenses[2u * slot + 1u] = lensOf(lane, scale * lane.across_D, lane.unblurred, lane.across_D);
#else
  float radius = max(lane.radius, 1e-6);
  lenses[slot] = lensOf(lane, radius, lane.narrow * radius * radius, lane.off_D);
#endif
#endif
#ifdef SUB_APERTURES
  float share = square(sub_aperture_shading.x);
  float missing = max(kOverlap * lane.added - share * lane.blur_min2 - lane.prefilter, 0.0);
  float own = 0.5 * (lane.vxx + lane.vyy) - lane.prefilter;
  Kernel sub = kernelOf(lane, missing > 0.0 ? 1.0 + missing / max(own, 1e-12) : 1.0, share, weight);
#ifdef FIELD
  vec2 of_blur = vec2(lane.blur_min2);
#elif defined(ASTIGMATIC)
  vec2 off_D = vec2(lane.off_D, lane.across_D);
  vec2 of_blur = kDisc * blur_lens.x * blur_lens.y * off_D * off_D;
#else
  vec2 off_D = vec2(lane.off_D, 0.0);
  vec2 of_blur = vec2(lane.blur_min2);
#endif
  vec2 rest = sqrt(max(1.0 - share - missing / max(of_blur, 1e-12), 0.0));
  if (!sub.sound) sub = kernel;
  sharper[3u * slot] = vec4(sub.q, sub.k.x);
  sharper[3u * slot + 1u] = vec4(sub.k.yz, sub.extent);
#ifdef FIELD
  mat2 moved_px = rest.x * (part.in_focus_px + from_focus_D * part.per_D_px);
  sharper[3u * slot + 2u] = vec4(moved_px[0], moved_px[1]);
#else
  sharper[3u * slot + 2u] = vec4(rest * off_D, lane.tilt);
#endif
#endif
}
