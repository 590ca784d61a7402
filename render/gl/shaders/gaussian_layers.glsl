// The layers of a tile (render/gaussians/layer_stack.h), for gaussian_composite.glsl. A job is one
// layer. Behind each of its views lies the mean of the next layer's views through nearby discs. The
// views of the layer before, as its discs see this layer, are planes at this layer's samples.

// `GpuJob` of render/gl/gaussian_layers.h.
struct Job {
  vec2 first_px;
  float step_px;
  int side;                         // samples
  uvec2 entries, discs;             // in the lists; first, number
  uint to;                          // of its first sample; of a layer behind, of its planes
  uint fronts, weights;             // views of the layer before; the first of the weights in them
  uint behind, mean;                // planes of the next layer, and of the mean of its views;
                                    // kNone: the background
  int behind_side;                  // samples of the next layer
  float behind_first, behind_step;  // the samples of this layer among them
  uint followed;                    // the first of its samples that are followed
  uint judged;                      // of a judge: the first of those that it judges
  int along;                        // followed along a side
  int follow_first, follow_apart;   // of these, the tile's samples
  int follow_ratio;                 // 0: the job has the tile's samples; else its step over theirs
};
layout(std430, binding = 2) readonly buffer Jobs { Job jobs[]; };
// Two vectors a sample: display values, coverage; linear light, distance times coverage. View after
// view, then their mean. Where they are read, the light is less that of the display values.
layout(std430, binding = 12) buffer Planes { vec4 planes[]; };
// Of the views of a layer in those of the layer before (`LensPairs`).
layout(std430, binding = 13) readonly buffer Weights { float weights[]; };

struct Light {
  vec4 display, light;
};

vec3 linearOf(vec3 display) {
  vec3 s = clamp(display, 0.0, 1.0);
  return mix(pow((s + 0.055) / 1.055, vec3(2.4)), s / 12.92, lessThanEqual(s, vec3(0.04045)));
}

struct Taps {
  int first;
  vec4 weights;
};

// As `interpolateBehind` of render/gaussians: beyond the edges, the parabola through the last three
// samples goes on.
Taps tapsAt(float at, int last) {
  int below = min(int(at), last - 1);
  vec4 w = catmullRom(at - float(below));
  if (below == 0) return Taps(0, vec4(w.y + 3.0 * w.x, w.z - 3.0 * w.x, w.w + w.x, 0.0));
  if (below == last - 1) {
    return Taps(last - 3, vec4(0.0, w.x + w.w, w.y - 3.0 * w.w, w.z + 3.0 * w.w));
  }
  return Taps(below - 1, w);
}

// What lies behind a sample.
// @param plane  of the next layer
Light lightBehind(Job job, ivec2 here, uint plane) {
  int side = job.behind_side;
  vec2 at = job.behind_first + job.behind_step * vec2(here);
  Taps across = tapsAt(at.x, side - 1), down = tapsAt(at.y, side - 1);
  Light sum = Light(vec4(0.0), vec4(0.0));
  for (int y = 0; y < 4; ++y) {
    uint from = plane + 2u * uint((down.first + y) * side + across.first);
    for (int x = 0; x < 4; ++x) {
      float weight = down.weights[y] * across.weights[x];
      sum.display += weight * planes[from + 2u * uint(x)];
      sum.light += weight * planes[from + 2u * uint(x) + 1u];
    }
  }
  rounds += 20u;
  return sum;
}

// Adds a view to those of the layer before, times its weights, as `compositeBehind` does. The last
// view completes them.
void addToFronts(Job job, ivec2 here, uint view, Light shown) {
  uint at = job.to + 2u * uint(here.y * job.side + here.x);
  uint plane = 2u * uint(job.side * job.side), row = job.weights + view * job.fronts;
  bool first = view == 0u, last = view + 1u == job.discs.y;
  Light sum = Light(vec4(0.0), vec4(0.0));
  for (uint j = 0u; j < job.fronts; ++j, at += plane) {
    float weight = weights[row + j];
    if (weight == 0.0 && !first && !last) continue;
    vec4 display = weight * shown.display, light = weight * shown.light;
    if (!first) {
      display += planes[at];
      light += planes[at + 1u];
    }
    if (last) {
      light.rgb -= linearOf(display.rgb);
      sum.display += display;
      sum.light += light;
    }
    planes[at] = display;
    planes[at + 1u] = light;
  }
  rounds += job.fronts;
  if (!last) return;
  planes[at] = sum.display / float(job.fronts);
  planes[at + 1u] = sum.light / float(job.fronts);
}
