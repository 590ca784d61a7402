// The layers of one sample: what render/splat/layers-inl.h, block-inl.h and edges-inl.h do for a
// SIMD vector of samples. LENS: the sums keep lens points.
#ifdef LENS
vec2 ramp;  // of the tile: linear to, opaque from
#else
const vec2 ramp = vec2(kLinearToSharp, kOpaqueFromSharp);
#endif

struct Sums {
  vec3 colour;
  float weight, visible, distance_m;
  vec2 mean;
#ifdef LENS
  float lens_weight, right, above, right_above;
  vec2 blocked;
#endif
};
struct Covering {
  float weight, share;
  vec2 mean;
};
struct Edge {
  float share;
  vec2 direction;
};

Sums facing, back_facing;  // the open layer
float far_m;               // end of its z-range; negative: none is open
vec3 light;
float light_m, transmittance;
Edge edge;                 // of the lens: share is the chord's distance from the centre
float outside, contrast;
#ifdef LENS
vec2 blocked;
float partial;
bool overlap;
#endif
#ifdef TRANSPARENT
bool transparent;  // some splat of the tile is
vec3 beyond;
float beyond_visible, beyond_m;
#else
const bool transparent = false;
#endif

Sums noSums() {
  Sums sums;
  sums.colour = vec3(0.0);
  sums.weight = sums.visible = sums.distance_m = 0.0;
  sums.mean = vec2(0.0);
#ifdef LENS
  sums.lens_weight = sums.right = sums.above = sums.right_above = 0.0;
  sums.blocked = vec2(0.0);
#endif
  return sums;
}

void clearSample() {
  facing = back_facing = noSums();
  far_m = -1.0;
  light = vec3(0.0);
  light_m = 0.0;
  transmittance = 1.0;
  edge = Edge(0.0, vec2(0.0));
  outside = 1.0;
  contrast = 0.0;
#ifdef LENS
  blocked = vec2(0.0);
  partial = 0.0;
#endif
#ifdef TRANSPARENT
  beyond = vec3(0.0);
  beyond_visible = beyond_m = 0.0;
#endif
}

float rampOf(float weight, float coverage, float linear_to, float opaque_from) {
  float steep = (weight - linear_to) * (1.0 - linear_to) / (opaque_from - linear_to) + linear_to;
  return min(max(weight * coverage, steep), 1.0);
}

float shareOf(float weight, float coverage) {
  return rampOf(weight, coverage, ramp.x, ramp.y);
}

#ifndef LENS
float straightnessOf(float weight, float length_) {
  float area = min(weight, 1.0), u = 4.0 * area * (1.0 - area);
  float density = kDensityPeak * u * (1.0 + kDensityBend - kDensityBend * u);
  return min(sqrt(kWidestSupport2) * length_ * area / max(density, 1e-6), 1.0);
}
#endif

Covering coveringOf(Sums sums, float coverage) {
  Covering c;
  c.weight = sums.weight;
  c.share = shareOf(sums.weight, coverage);
#ifdef LENS
  float inv = 1.0 / max(sums.lens_weight, 1e-20);
  c.mean = sums.mean * inv;
  float length_ = length(c.mean);
  float m = clamp(min(length_ * kMeanScale - kMeanNoise, length_ * kFoldScale - kFoldMean), 0.0, 1.0);
  float segment = (1.0 - m) * (1.0 - kSegmentBend * m * m), scale = sums.weight * inv;
  float neither = max(sums.lens_weight + sums.right_above - (sums.right + sums.above), 0.0);
  vec4 quarters = vec4(sums.right_above, sums.right - sums.right_above,
                       sums.above - sums.right_above, neither);
  float by_quarters = shareOf(dot(min(quarters * scale, 0.25), vec4(1.0)), coverage);
  c.share = min(c.share, max(by_quarters, segment * coverage));
#else
  c.mean = sums.mean / max(sums.weight, 1e-20);
  float straight = straightnessOf(sums.weight, length(c.mean));
  float closed = rampOf(sums.weight, coverage, kLinearToHole, kOpaqueFromHole);
  c.share = mix(closed, c.share, square(straight * straight));
#endif
  return c;
}

float chordAt(float share) {
  float x = 2.0 * share - 1.0, x2 = x * x, x4 = x2 * x2;
  return -x * (kChord12 * x4 * x4 * x4 + kChord4 * x4 + kChord0);
}

float straightness(float length_, float share, float at) {
  float c = max(1.0 - at * at, 0.0), moment = kHalfDiscMoment * c * sqrt(c);
  return min(length_ * share / max(moment, 1e-6), 1.0);
}

Edge edgeOf(Covering side) {
  float length_ = length(side.mean);
#ifdef LENS
  float straight = straightness(length_, side.share, chordAt(side.share));
#else
  float straight = straightnessOf(side.weight, length_);
#endif
  return Edge(side.share, side.mean * (straight / max(length_, 1e-6)));
}

float apart(Edge a, Edge b) {
  float r = max(-dot(a.direction, b.direction), 0.0), r4 = square(r * r);
  return r * (kArcSine + (1.0 - kArcSine) * r4 * r4);
}

float leastShared(Edge a, Edge b) { return max(a.share + b.share - 1.0, 0.0); }

float besideFront(Edge front, Edge back_) {
  float hidden = min(front.share, back_.share);
  return back_.share - (hidden + apart(front, back_) * (leastShared(front, back_) - hidden));
}

float seenOverIndependent(Edge front, float opacity, Edge behind) {
  float independent = front.share * behind.share;
  float both = independent + apart(front, behind) * (leastShared(front, behind) - independent);
  float passes = 1.0 - opacity * front.share;
  return (behind.share - opacity * both) / max(passes * behind.share, 1e-6);
}

#ifdef LENS
void findOverlap(float weight) {
  float covered = min(weight, 1.0);
  overlap = overlap || covered * partial > kPartial ||
            (weight > kTwoSurfaces && transmittance > kPartial);
  partial = max(partial, transmittance * min(covered, 1.0 - covered));
}

void findLensEdge() {
  float hidden = 1.0 - transmittance;
  if (!(hidden > kPartial && transmittance > kPartial)) return;
  vec2 mean = blocked / hidden;
  float at = chordAt(hidden), length_ = length(mean), share = straightness(length_, hidden, at);
  contrast = share / transmittance;
  outside = (1.0 - (share + (1.0 - share) * hidden)) / transmittance;
  edge = Edge(at, mean / max(length_, 1e-6));
}
#else
void findPixelEdge(Covering layer, float alpha, float seen) {
  if (!(layer.share > kPartial && alpha < 1.0 - kPartial)) return;
  float independent = min(alpha / max(seen, 1e-6), 1.0);
  float now = independent / max(1.0 - independent, 1e-3);
  if (!(now > contrast)) return;
  edge = edgeOf(layer);
  outside = min(independent / edge.share, 1.0);
  contrast = now;
}
#endif

// Composites `colour` and the rest of a layer's sums; returns what they add to its alpha.
float composite(Sums sums, float summed, float share, float seen) {
  float scale = share * seen / max(summed, 1e-20), passed = transmittance * scale;
  light += passed * sums.colour;
#ifdef DEPTH
  light_m += passed * sums.distance_m;
#endif
#ifdef LENS
  blocked += passed * sums.blocked;
#endif
#ifdef LENS
  return scale * sums.visible;
#else
  return scale * (transparent ? sums.visible : summed);
#endif
}

void closeLayer(float coverage) {
  Covering all = coveringOf(facing, coverage);
#ifdef LENS
  findOverlap(all.weight);
#endif
  float summed = min(all.weight, kOpaqueWeight), seen = 1.0;
#ifdef TRANSPARENT
  // Sampling noise joins the surface, the rest is a layer behind it (`joinBeyond`).
  float later = transparent ? max(facing.weight - kOpaqueWeight, 0.0) : 0.0;
  float same = clamp((kAnother - later) / (kAnother - kNoise), 0.0, 1.0);
  facing.colour += same * beyond;
  facing.visible += same * beyond_visible;
  facing.distance_m += same * beyond_m;
  summed += same * later;
  float rest = (1.0 - same) * later;
#endif
  float front = all.share;
  Covering other = coveringOf(back_facing, coverage);
  float back_weight = min(other.weight, kOpaqueWeight);
  float more = besideFront(edgeOf(all), edgeOf(other));
  all.weight = max(all.weight, other.weight);
  float total = all.share + more;
  all.mean += more / max(total, 1e-20) * (other.mean - all.mean);
  all.share = total;
#ifndef LENS
  seen = seenOverIndependent(edge, outside, edgeOf(all));
  if (edge.share == 0.0) seen = 1.0;
#endif
  float alpha = composite(facing, summed, front, seen);
  alpha += composite(back_facing, back_weight, more, seen);
#ifdef LENS
  transmittance *= 1.0 - min(alpha, 1.0);
  findLensEdge();
#else
  findPixelEdge(all, alpha, seen);
  transmittance *= 1.0 - min(alpha, 1.0);
#endif
#ifdef TRANSPARENT
  if (rest > 0.0) {
    float scale = min(rest, 1.0) / rest * (1.0 - same);
    light += transmittance * scale * beyond;
    light_m += transmittance * scale * beyond_m;
    transmittance *= 1.0 - min(scale * beyond_visible, 1.0);
  }
  beyond = vec3(0.0);
  beyond_visible = beyond_m = 0.0;
#endif
  facing = back_facing = noSums();
  far_m = -1.0;
}
