// One level of the LOD cut: each node decides for itself, from the share that its parent leaves.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Places { vec4 place[]; };      // position, radius; m
layout(std430, binding = 1) readonly buffer Coarseness { float coarse[]; };  // m^2
layout(std430, binding = 2) writeonly buffer Own { float own[]; };         // weight that renders
layout(std430, binding = 3) buffer Passed { float passed[]; };             // weight for children

layout(location = 0) uniform int level;

const float kFade = 0.3, kWidestReach = 3.0, kOutside = -1.0, kRefine = 1e30;

float finest(float from_gaze) { return max(acuity.z + acuity.w * from_gaze, 1.0); }

// Selector::sizeOf of render/lod/cut.cpp.
float sizeOf(vec4 node, float coarseness) {
  vec3 from_eye = node.xyz - vec3(right.w, up.w, back.w);
  vec3 p = vec3(dot(right.xyz, from_eye), dot(up.xyz, from_eye), dot(back.xyz, from_eye));
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
  float off_D = abs(inv - focus.x);
  vec2 reach = kWidestReach * (0.5 * spread + 0.6 * (off_D + focus.w + range_D) * view_px.zw +
                               finest(length(at - acuity.xy)));
  if (any(lessThan(at + reach, vec2(0.0))) || any(greaterThan(at - reach, vec2(size.xy)))) {
    return kOutside;
  }
  float min_D = max(abs(off_D - focus.w) - range_D, 0.0);
  float detail = finest(length(max(abs(at - acuity.xy) - reach, 0.0)));
  float allowed = cut.x * view_px.z * view_px.w * min_D * min_D + cut.y +
                  cut.z * (detail * detail - 1.0);
  return coarseness * focal_principal_px.x * focal_principal_px.y / (depth * depth * allowed);
}

void main() {
  uint count = 1u << level;
  if (gl_GlobalInvocationID.x >= count) return;
  uint node = count + gl_GlobalInvocationID.x;
  float weight = level == 0 ? 1.0 : passed[node >> 1];
  float mine = 0.0, rest = 0.0;
  if (weight > 0.0) {
    float now = sizeOf(place[node], coarse[node]);
    if (now != kOutside) {
      float children = min((now - 1.0) * (1.0 / kFade), 1.0);
      if (children < 1.0) mine = weight * (children > 0.0 ? 1.0 - children : 1.0);
      if (children > 0.0) rest = weight * children;
    }
  }
  own[node] = mine;
  passed[node] = rest;
}
