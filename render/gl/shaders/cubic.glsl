// Weights of four samples in a row, `t` of the way from the second to the third (Catmull and Rom
// 1974).
vec4 catmullRom(float t) {
  return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (-5.0 + 3.0 * t),
                    t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
}
