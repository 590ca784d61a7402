// Standard errors of the mean of each tile's views, at the samples that gaussian_composite.glsl
// follows: `standardErrors` of render/gaussians/view_spread.h. One work group a tile.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Lenses { uvec2 lens_of[]; };  // by tile: first disc, number
layout(std430, binding = 1) readonly buffer Follows { vec4 followed[]; };
layout(std430, binding = 2) writeonly buffer Errors { float errors_jnd[]; };

// `visibleDifferencePerLight` of render/image/visible_difference.cpp.
const float kJustNoticeable = 2.3, kLinearBelow = 0.008856, kLinearSlope = 7.787;
const mat3 kXyzOfWhite = mat3(0.412453 / 0.950456, 0.212671, 0.019334 / 1.088754,
                              0.357580 / 0.950456, 0.715160, 0.119193 / 1.088754,
                              0.180423 / 0.950456, 0.072169, 0.950227 / 1.088754);
const mat3 kLabOfCurve = mat3(0.0, 500.0, 0.0, 116.0, -500.0, 200.0, 0.0, 0.0, -200.0);

float slopeOf(float t) {
  return t > kLinearBelow ? pow(t, -2.0 / 3.0) / 3.0 : kLinearSlope;
}

mat3 jndPerLight(vec3 light) {
  vec3 xyz = kXyzOfWhite * clamp(light, 0.0, 1.0);
  vec3 slope = vec3(slopeOf(xyz.x), slopeOf(xyz.y), slopeOf(xyz.z)) / kJustNoticeable;
  return kLabOfCurve * mat3(slope * kXyzOfWhite[0], slope * kXyzOfWhite[1], slope * kXyzOfWhite[2]);
}

void main() {
  uint tile = gl_WorkGroupID.x;
  float n = float(lens_of[tile].y);
  if (n < 2.0) return;
  uint at = tile * kFollowed + gl_LocalInvocationIndex;
  vec4 a = followed[3u * at], b = followed[3u * at + 1u], c = followed[3u * at + 2u];
  // Of the light less that of the first view: sums, and sums of products.
  vec3 sum = vec3(a.w, b.xy);
  mat3 products = mat3(b.z, b.w, c.x, b.w, c.y, c.z, c.x, c.z, c.w);
  mat3 apart = products - outerProduct(sum, sum) / n;
  mat3 jnd = jndPerLight(a.xyz + sum / n);
  mat3 shown = jnd * apart * transpose(jnd);
  float squares = max(shown[0][0] + shown[1][1] + shown[2][2], 0.0);
  errors_jnd[at] = sqrt(squares / (n * (n - 1.0)));
}
