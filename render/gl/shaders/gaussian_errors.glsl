// The spread of a layer's views at the samples that gaussian_composite.glsl follows:
// `SpreadSquares` of render/gaussians/view_spread.h, their mean transmittance, and how far their
// mean is from the view that is judged. One thread a sample.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Follows { vec4 followed[]; };
layout(std430, binding = 1) writeonly buffer Squares { vec4 squares[]; };
layout(location = 0) uniform uint sample_count;
layout(location = 1) uniform uint first_square;  // of the batch

// `visibleDifferencePerLight` of render/image/metrics.cpp.
float slopeOf(float t) {
  return t > kLinearBelow ? pow(t, -2.0 / 3.0) / 3.0 : kLinearSlope;
}

mat3 jndPerLight(vec3 light) {
  vec3 xyz = kXyzOfWhite * clamp(light, 0.0, 1.0);
  vec3 slope = vec3(slopeOf(xyz.x), slopeOf(xyz.y), slopeOf(xyz.z)) / kJustNoticeable;
  return kLabOfCurve * mat3(slope * kXyzOfWhite[0], slope * kXyzOfWhite[1], slope * kXyzOfWhite[2]);
}

float squareOf(vec3 v) { return dot(v, v); }

void main() {
  uint at = threadIndex(64u);
  if (at >= sample_count) return;
  vec4 f[8];
  for (uint i = 0u; i < 8u; ++i) f[i] = followed[8u * at + i];
  float n = f[7].x;
  // Of the light less that of the first view: sums, and sums of products.
  vec3 sum = vec3(f[0].w, f[1].xy);
  mat3 products = mat3(f[1].z, f[1].w, f[2].x, f[1].w, f[2].y, f[2].z, f[2].x, f[2].z, f[2].w);
  mat3 apart = products - outerProduct(sum, sum) / n;
  mat3 jnd = jndPerLight(f[0].xyz + sum / n);
  mat3 shown = jnd * apart * transpose(jnd);
  float all = max(shown[0][0] + shown[1][1] + shown[2][2], 0.0);
  float smooth_ = squareOf(jnd * f[3].xyz) + squareOf(jnd * vec3(f[3].w, f[4].xy)) +
                  squareOf(jnd * vec3(f[4].zw, f[5].x)) + squareOf(jnd * f[5].yzw) +
                  squareOf(jnd * f[6].xyz);
  squares[first_square + at] =
      vec4(all, max(all - smooth_, 0.0), f[7].y / n, length(jnd * sum / n));
}
