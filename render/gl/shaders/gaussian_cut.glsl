// One level of the LOD cut of a scene of Gaussians, as `NodeSelector` of
// render/gaussians/gaussian_cut.cpp makes it. A node is seen where its parent is too coarse.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Places { vec4 place[]; };    // position, radius; m
layout(std430, binding = 1) readonly buffer Spreads { float spread[]; };  // m^2
layout(std430, binding = 2) writeonly buffer Own { float own[]; };        // 1: renders
layout(std430, binding = 3) buffer Passed { float passed[]; };            // 1: too coarse

layout(location = 0) uniform int level;
layout(location = 1) uniform float max_px2;

const int kOutside = 0, kFine = 1, kCoarse = 2;

int see(uint node) {
  vec3 p = inEyeAxes(fromEye(place[node].xyz));
  float radius = place[node].w, depth = -p.z, near_m = cut.w;
  if (depth + radius < near_m) return kOutside;
  float nearest_m = depth - radius;
  if (!(nearest_m >= near_m)) return kCoarse;
  float distance_m = scene.z != 0 ? depth : length(p);
  float range_D = radius / (distance_m * max(distance_m - radius, near_m));
  vec2 offset = focal_principal_px.xy * vec2(p.x, -p.y) / depth;
  vec2 at = view_px.xy + offset;
  vec2 spread_px = radius / nearest_m * (focal_principal_px.xy + abs(offset));
  vec2 off_D = offFocus(offset, length(spread_px), 1.0 / distance_m, range_D);
  vec2 reach = spread_px + 2.0 * off_D.y * view_px.zw + kLowPassReach_px;
  if (any(lessThan(at + reach, vec2(0.0))) || any(greaterThan(at - reach, vec2(size.xy)))) {
    return kOutside;
  }
  float finest_px = finest(length(max(abs(at - acuity.xy) - reach, 0.0)));
  float allowed_px2 = min(cut.x * view_px.z * view_px.w * off_D.x * off_D.x, max_px2) + cut.y +
                      cut.z * (finest_px * finest_px - 1.0);
  float spread_px2 =
      spread[node] * focal_principal_px.x * focal_principal_px.y / (depth * depth);
  return spread_px2 <= allowed_px2 ? kFine : kCoarse;
}

void main() {
  uint count = 1u << level, node = count + threadIndex(64u);
  if (node >= 2u * count) return;
  int seen = level == 0 || passed[node >> 1] > 0.0 ? see(node) : kOutside;
  own[node] = seen == kFine ? 1.0 : 0.0;
  passed[node] = seen == kCoarse ? 1.0 : 0.0;
}
