// Projects Gaussians and nodes of the cut: what render/gaussians/projected.cpp does, which has the
// formulas. One thread an entry. DEGREE is that of the harmonics.

layout(std430, binding = 0) readonly buffer Entries { uvec2 entries[]; };
layout(std430, binding = 3) readonly buffer Nodes { vec4 node[]; };
// Four vectors a Gaussian and a node: (position, opacity); (xx, xy, xz, yy), (yz, zz, growth, 0) of
// the covariance; (colour, 0).
layout(std430, binding = 1) readonly buffer Gaussians { vec4 gaussian[]; };
#if DEGREE > 0
// Packed in pairs: red, green and blue of each harmonic in turn.
layout(std430, binding = 2) readonly buffer Harmonics { uint harmonics[]; };
layout(std430, binding = 6) readonly buffer NodeHarmonics { uint node_harmonics[]; };
#endif
// Two vectors each: (x, y, vxx, vxy), (vyy, sx, sy, e); (off_D, opacity, cut, distance), (colour, 0).
layout(std430, binding = 4) writeonly buffer ProjectedA { vec4 projected_a[]; };
layout(std430, binding = 8) writeonly buffer ProjectedB { vec4 projected_b[]; };
layout(std430, binding = 9) readonly buffer Sizes { vec2 sizes[]; };  // max_radius, aperture

// Of both arrays the shader sees a window: first node, number, first Gaussian, number.
layout(location = 0) uniform uvec4 window;
layout(location = 1) uniform int size_count;

struct Gaussian {
  vec3 position, colour;
  float opacity, growth_per_m2;
  mat3 covariance;
};

// @param first  of its four vectors
#define GAUSSIAN_OF(from, first)                                                           \
  Gaussian(from[first].xyz, from[first + 3u].rgb, from[first].w, from[first + 2u].z,       \
           mat3(from[first + 1u].xyz, from[first + 1u].yw, from[first + 2u].x,             \
                from[first + 1u].z, from[first + 2u].xy))

#if DEGREE > 0
const int kCoefficients = 3 * ((DEGREE + 1) * (DEGREE + 1) - 1);
const uint kWords = uint(kCoefficients + 1) / 2u;  // of a Gaussian

// In steps (kHarmonicsStep). @param i  within the window
float coefficientOf(bool is_node, uint i, int k) {
  uint at = i * kWords + uint(k >> 1);
  uint word = is_node ? node_harmonics[at] : harmonics[at];
  return float(bitfieldExtract(int(word), 16 * (k & 1), 16));
}

// `harmonicsIn` of render/scene/harmonics.h.
void harmonicsIn(vec3 d, out float y[15]) {
  y[0] = -kHarmonic1 * d.y;
  y[1] = kHarmonic1 * d.z;
  y[2] = -kHarmonic1 * d.x;
  float xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
  y[3] = kHarmonic2a * d.x * d.y;
  y[4] = -kHarmonic2a * d.y * d.z;
  y[5] = kHarmonic2b * (2.0 * zz - xx - yy);
  y[6] = -kHarmonic2a * d.x * d.z;
  y[7] = kHarmonic2c * (xx - yy);
  y[8] = -kHarmonic3a * d.y * (3.0 * xx - yy);
  y[9] = kHarmonic3b * d.x * d.y * d.z;
  y[10] = -kHarmonic3c * d.y * (4.0 * zz - xx - yy);
  y[11] = kHarmonic3d * d.z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
  y[12] = -kHarmonic3c * d.x * (4.0 * zz - xx - yy);
  y[13] = kHarmonic3e * d.z * (xx - yy);
  y[14] = -kHarmonic3a * d.x * (xx - 3.0 * yy);
}

vec3 harmonicsOf(bool is_node, uint i, vec3 direction) {
  float y[15];
  harmonicsIn(direction, y);
  vec3 sum = vec3(0.0);
  for (int k = 0; 3 * k < kCoefficients; ++k) {
    sum += y[k] * vec3(coefficientOf(is_node, i, 3 * k), coefficientOf(is_node, i, 3 * k + 1),
                       coefficientOf(is_node, i, 3 * k + 2));
  }
  return kHarmonicsStep * sum;
}
#endif

float peakOf(float opacity) { return opacity > 1.0 ? exp(opacity - 1.0) : opacity; }

// `blurRadius_px` of render/optics/defocus.h.
vec2 blurRadius_px(float off_D) {
  return view_px.zw * vec2(length(vec2(off_D - focus.y, focus.z)),
                           length(vec2(off_D + focus.y, focus.z)));
}

void projectEntry(uint slot) {
#ifdef CUT
  uint index = entries[slot].x;
  bool is_node = slot < cut_nodes;
#else
  uint index = slot;
  const bool is_node = false;
#endif
  uint i = index - (is_node ? window.x : window.z);  // wraps around before the window
  if (i >= (is_node ? window.y : window.w)) return;
  writeNoKey(slot);
  Gaussian g;
  if (is_node) g = GAUSSIAN_OF(node, 4u * i);
  else g = GAUSSIAN_OF(gaussian, 4u * i);

  vec3 from_eye = fromEye(g.position);
  vec3 p = inEyeAxes(from_eye);
  float depth = -p.z;
  if (!(depth >= cut.w)) return;
  float inverse_ = 1.0 / depth;
  vec2 focal = focal_principal_px.xy, principal = view_px.xy, image = vec2(size.xy);
  vec2 margin = (kFieldMargin - 1.0) * 0.5 * image;
  vec2 tangent = vec2(p.x, -p.y) * inverse_;
  vec2 at = clamp(tangent, -(principal + margin) / focal, (image - principal + margin) / focal);
  vec3 row_x = focal.x * inverse_ * (right.xyz + at.x * back.xyz);
  vec3 row_y = focal.y * inverse_ * (at.y * back.xyz - up.xyz);
  vec3 sx = g.covariance * row_x, sy = g.covariance * row_y;
  float xx = dot(row_x, sx), xy = dot(row_x, sy), yy = dot(row_y, sy);
  float vxx = xx + kLowPass_px2, vyy = yy + kLowPass_px2;
  vec2 centre = principal + focal * tangent;

  float opacity = g.opacity;
  bool preserves_light = scene.w != 0;
  if (preserves_light || is_node) {
    float shrinkage = sqrt(max(xx * yy - xy * xy, 0.0) / (vxx * vyy - xy * xy));
    float growth = 1.0 + g.growth_per_m2 * kLowPass_px2 * depth * depth / (focal.x * focal.y);
    opacity = preserves_light
                  ? opacity * shrinkage
                  : kMinAlpha + log(1.0 + growth * shrinkage * (exp(opacity - kMinAlpha) - 1.0));
  }
  if (!(opacity > kMinAlpha)) return;
  float end = 2.0 * log(peakOf(opacity) / kMinAlpha);

  float far_m = length(p);
  bool by_sight = scene.z == 0;
  float distance_m = by_sight ? far_m : depth;
  vec3 gradient = by_sight ? -from_eye / (far_m * far_m * far_m) : back.xyz * inverse_ * inverse_;
  float e = max(dot(gradient, g.covariance * gradient), 0.0);

  // The key, as `Projection::place` fills it.
#ifdef FIELD
  LocalLens lens = lensAt(focal * tangent);
  mat2 per_D = lens.p * lens.s;
  vec2 bounds_px = blurBounds_px(lens, 0.0, 1.0 / distance_m, 0.0);
  vec2 radius = vec2(length(vec2(per_D[0][0], per_D[1][0])), length(vec2(per_D[0][1], per_D[1][1])));
  vec2 blur = bounds_px.yy;
  float least_px = bounds_px.x;
#else
  vec2 radius = view_px.zw, blur = blurRadius_px(1.0 / distance_m - focus.x);
  float least_px = min(blur.x, blur.y);
#endif
  vec2 reach = vec2(0.0);
  bool blurs = false;
  for (int k = 0; k < size_count; ++k) {
    vec2 each = sizes[k];
    blurs = blurs || each.x > 0.0 || each.y > 0.0;
    vec2 sheared = sqrt(vec2(vxx, vyy)) + sqrt(e) * each.x * radius;
    vec2 disc = kDisc * each.y * each.y * (blur * blur + e * radius * radius);
    reach = max(reach, each.x * blur + sqrt(end * (sheared * sheared + disc)));
  }
  vec2 low = centre - reach, high = low + 2.0 * reach;
  if (!(all(greaterThanEqual(high, vec2(0.0))) && all(lessThan(low, image)))) return;
  uvec2 first = uvec2(clamp(low, vec2(0.0), image - 1.0));
  uvec2 last = uvec2(clamp(high, vec2(0.0), image - 1.0));
  writeKey(slot, depth, first, last,
           log2StepFor(blurs ? kSigmaPerBlur * least_px : 0.0), max(blur.x, blur.y));

  vec3 colour = g.colour;
#if DEGREE > 0
  colour += harmonicsOf(is_node, i, from_eye / far_m);
#endif
  projected_a[2u * slot] = vec4(centre, vxx, xy);
  projected_a[2u * slot + 1u] = vec4(vyy, dot(sx, gradient), dot(sy, gradient), e);
  projected_b[2u * slot] = vec4(focus.x - 1.0 / distance_m, opacity, end, distance_m);
  projected_b[2u * slot + 1u] = vec4(max(colour, 0.0), 0.0);
}
