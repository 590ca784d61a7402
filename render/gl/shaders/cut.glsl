// One level of the LOD cut, as `Selector` of render/lod/cut.cpp makes it: each node decides for
// itself, from the share and the bounds that its parent leaves.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Places { vec4 place[]; };      // position, radius; m
// As bits: now, min, the variance that merging added, m^2; packed normal.
layout(std430, binding = 1) readonly buffer Coarseness { uvec4 coarse[]; };
layout(std430, binding = 2) writeonly buffer Own { float own[]; };         // weight that renders
layout(std430, binding = 3) buffer Passed { float passed[]; };             // weight for children
// Of size over coarseness, for all nodes below: min, max; whether their centres are on the image;
// whether none of their surfels is a hidden back face.
layout(std430, binding = 4) buffer AllBounds { vec4 bounds[]; };
#ifdef BODIES
layout(std430, binding = 5) readonly buffer AllFacing { uint facing[]; };
layout(std430, binding = 8) readonly buffer Outside { uint outside[]; };  // by body
#endif

layout(location = 0) uniform int level;

const float kOutside = -1.0, kRefine = 1e30;
const vec4 kNoBounds = vec4(0.0, kRefine, 0.0, 0.0);

float blurred(float defocus_D) {
  return cut.x * view_px.z * view_px.w * defocus_D * defocus_D;
}

float allowed(float defocus_D, float detail) {
  return blurred(defocus_D) + cut.y + cut.z * (detail * detail - 1.0);
}

// Bounds of the allowed variance within a range of pixels.
// @param off_D  `offFocus`
float minAllowed(vec2 off_D, vec2 at, vec2 reach) {
  return allowed(off_D.x, finest(length(max(abs(at - acuity.xy) - reach, 0.0))));
}
float maxAllowed(vec2 off_D, vec2 at, vec2 reach) {
  return allowed(off_D.y, finest(length(abs(at - acuity.xy) + reach)));
}

float perCoarseness(float depth, float allowed_px2) {
  return focal_principal_px.x * focal_principal_px.y / (depth * depth * allowed_px2);
}

// `coarsenessInView` of render/lod/cut.cpp.
float coarsenessInView(vec3 from_eye, uvec4 coarseness, float sharp) {
  float along = dot(unpackNormal(coarseness.w), from_eye);
  float cos2 = along * along / dot(from_eye, from_eye);
  float shows = sqrt((3.0 + cos2 * (2.0 + 3.0 * cos2)) / 8.0);
  return uintBitsToFloat(coarseness.x) - sharp * (1.0 - shows) * uintBitsToFloat(coarseness.z);
}

float sizeOf(vec4 node, uvec4 coarseness, out vec4 below) {
  below = kNoBounds;
  vec3 from_eye = fromEye(node.xyz);
  vec3 p = inEyeAxes(from_eye);
  float radius = node.w, depth = -p.z, near_m = cut.w;
  if (depth + radius < near_m) return kOutside;
  float nearest = depth - radius;
  if (nearest < near_m) return kRefine;

  float distance_m = scene.z != 0 ? depth : length(p);
  float inv = 1.0 / distance_m;
  float range_D = radius * inv / max(distance_m - radius, near_m);
  vec2 offset = focal_principal_px.xy * vec2(p.x, -p.y) / depth;
  vec2 at = view_px.xy + offset;
  vec2 spread = radius / nearest * (focal_principal_px.xy + abs(offset));
  vec2 off_D = offFocus(offset, length(spread), inv, range_D);
  vec2 reach = kWidestReach *
               (0.5 * spread + 0.6 * off_D.y * view_px.zw + finest(length(at - acuity.xy)));
  float margin = float(size.z);
  if (any(lessThan(at + reach, vec2(-margin))) ||
      any(greaterThan(at - reach, vec2(size.xy) + margin))) {
    return kOutside;
  }
  float allows = minAllowed(off_D, at, reach);
  float sharp = 1.0 - blurred(off_D.x) / allows;
  bool foreshortened = cut_switches.x != 0;
  float now = (foreshortened ? coarsenessInView(from_eye, coarseness, sharp)
                             : uintBitsToFloat(coarseness.x)) * perCoarseness(depth, allows);
  float around = 3.0 * radius;
  if (depth - around < near_m) return now;
  float around_D = around * inv / max(distance_m - around, near_m);
  bool in_view = all(greaterThan(at, spread)) && all(lessThan(at + spread, vec2(size.xy)));
  float shows = foreshortened ? kEdgeOn : 1.0;
  off_D = offFocus(offset, 3.0 * length(spread), inv, around_D);
  below = vec4(shows * perCoarseness(depth + around, maxAllowed(off_D, at, 3.0 * reach)),
               perCoarseness(depth - around, minAllowed(off_D, at, 3.0 * reach)),
               in_view ? 1.0 : 0.0, 0.0);
  return now;
}

#ifdef BODIES
// -1: all surfels below the node are hidden back faces; 1: none is; 0: some may be.
int sideOf(uint i) {
  uint body = facing[i] & 0xFFFFu;
  if (body == kSeveral) return 0;
  if (outside[body] == 0u) return 1;
  float cos_cone = float(facing[i] >> 16) * (1.0 / 65535.0);
  if (cos_cone == 0.0) return 0;
  float sin_cone = sqrt(max(1.0 - cos_cone * cos_cone, 0.0));
  vec3 p = place[i].xyz - vec3(right.w, up.w, back.w);
  float along = dot(unpackNormal(coarse[i].w), p);
  float across = sqrt(max(dot(p, p) - along * along, 0.0));
  float reach = place[i].w + sub_aperture_shading.w;
  if (along * cos_cone - across * sin_cone > reach) return -1;
  return along * cos_cone + across * sin_cone < -reach ? 1 : 0;
}
#endif

void main() {
  uint count = 1u << level, node = count + threadIndex(64u);
  if (node >= 2u * count) return;
  float weight = level == 0 ? 1.0 : passed[node >> 1];
  vec4 above = level == 0 ? kNoBounds : bounds[node >> 1];
  own[node] = 0.0;
  passed[node] = weight == kWhole ? kWhole : 0.0;
  if (weight == 0.0 || weight == kWhole) return;

#ifdef BODIES
  if (above.w == 0.0) {
    int side = sideOf(node);
    if (side < 0) return;
    above.w = float(side);
  }
#endif
  float seen = above.w;
  uvec4 coarseness = coarse[node];
  float plain = uintBitsToFloat(coarseness.x);
  float now = plain * above.x;
  bool known = now >= 1.0 + kCutFade || plain * above.y <= 1.0;
  if (above.z == 0.0 || !known) {
    now = sizeOf(place[node], coarseness, above);
    if (now == kOutside) return;
    above.w = seen;
  }
  if (weight == 1.0 && node >= uint(room.w) && uintBitsToFloat(coarseness.y) * above.x >= 1.0 + kCutFade) {
    passed[node] = kWhole;
    return;
  }
  bounds[node] = above;
  float children = min((now - 1.0) * (1.0 / kCutFade), 1.0);
  if (children < 1.0) own[node] = weight * (children > 0.0 ? 1.0 - children : 1.0);
  if (children > 0.0) passed[node] = weight * children;
}
