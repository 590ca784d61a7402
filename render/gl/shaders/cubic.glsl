// `cubicTaps` of render/splat/bin.h.
vec4 cubicTaps(float t) {
  float bend = -kBend / 6.0 * t * (1.0 - t);
  float before = bend * (2.0 - t), after = bend * (1.0 + t);
  return vec4(before, 1.0 - t - 2.0 * before + after, t + before - 2.0 * after, after);
}
