// What sweep.glsl and gaussian_composite.glsl share. A work group is a square of kGroup x kGroup
// samples of a tile, one thread a sample. It takes the tile's splats in batches and keeps those that
// touch its samples.
layout(local_size_x = kGroup, local_size_y = kGroup) in;

layout(std430, binding = 0) readonly buffer Work { uint work_items[]; };
layout(std430, binding = 1) readonly buffer Tiles { ivec4 tiles[]; };
layout(std430, binding = 3) readonly buffer Ranges { uvec2 range[]; };
layout(std430, binding = 4) readonly buffer Lists { uvec2 list[]; };
layout(std430, binding = 8) buffer Samples { vec4 samples[]; };
#ifdef DEPTH
layout(std430, binding = 9) buffer Depths { float depths[]; };
#endif

const uint kBatch = uint(kGroup * kGroup);

shared uint touching[2];  // bits of the batch's splats
shared uint translucent, fragments;

uint counted, rounds;  // of this sample

// Samples of a tile or of one of its layers, and what they show.
struct Grid {
  vec2 first_px;
  float step_px;
  int side;       // samples
  uvec2 entries;  // in the lists
};

Grid gridOf(uint index) {
  ivec4 tile = tiles[index];
  float step_px = float(tile.w), apron = tile.w > 1 ? float(kApron) : 0.0;
  return Grid(vec2(tile.xy) + step_px * (0.5 - apron), step_px, samplesOf(tile),
              min(range[index], uvec2(room.y)));
}

// The work group's square of a grid, and this thread's sample.
struct Square {
  int groups;                     // work groups along the grid's side
  ivec2 here;                     // this sample
  bool exists;                    // it lies in the grid
  vec2 at_px, first_px, last_px;  // this sample; the first and the last of the square
};

Square squareOf(Grid grid, uint part) {
  int groups = (grid.side + kGroup - 1) / kGroup;
  ivec2 corner = kGroup * ivec2(int(part) % groups, int(part) / groups);
  ivec2 here = corner + ivec2(gl_LocalInvocationID.xy);
  counted = rounds = 0u;
  if (gl_LocalInvocationIndex == 0u) fragments = 0u;
  return Square(groups, here, all(lessThan(here, ivec2(grid.side))),
                grid.first_px + grid.step_px * vec2(here),
                grid.first_px + grid.step_px * vec2(corner),
                grid.first_px + grid.step_px * vec2(min(corner + kGroup, ivec2(grid.side)) - 1));
}

// A tile's sample.
uint placeOf(uint tile, ivec2 here) {
  return tile * uint(kMostSamples * kMostSamples) + uint(here.y * kMostSamples + here.x);
}

void beginBatch() {
  uint me = gl_LocalInvocationIndex;
  barrier();
  if (me < 2u) touching[me] = 0u;
  if (me == 0u) translucent = 0u;
  barrier();
}

// @param mine  whether this thread's splat touches the square
// @param open  whether this thread's sample is still translucent
// @return whether any sample is
bool markBatch(bool mine, bool open) {
  uint me = gl_LocalInvocationIndex;
  if (mine) atomicOr(touching[me >> 5], 1u << (me & 31u));
  if (open) atomicAdd(translucent, 1u);
  barrier();
  return translucent != 0u;
}

// The place of this thread's splat among those that touch the square.
uint placeInBatch() {
  uint me = gl_LocalInvocationIndex, below = touching[me >> 5] & ((1u << (me & 31u)) - 1u);
  return uint(bitCount(below)) + (me >= 32u ? uint(bitCount(touching[0])) : 0u);
}

uint batchSize() { return uint(bitCount(touching[0]) + bitCount(touching[1])); }

// Adds what was counted to the frame's totals.
void finishSquare() {
  if (rounds > sweep_rounds) atomicMax(sweep_rounds, rounds);
  barrier();
  atomicAdd(fragments, counted);
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  uint sum = atomicAdd(fragments_low, fragments);
  if (sum + fragments < sum) atomicAdd(fragments_high, 1u);
}
