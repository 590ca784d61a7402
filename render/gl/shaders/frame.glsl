// What every stage of a frame shares: its parameters and counts. Constants that the CPU has too come before it
// (shader_text.cpp).
// render/gl/frame_stages.h fills the block.
layout(std140, binding = 0) uniform Frame {
  vec4 right, up, back;  // rows of the rotation; w: the eye's place in the world, x, y, z, metres
  vec4 focal_principal_px;  // as the aperture's centre sees it: focal x, y, principal x, y
  vec4 view_px;             // principal point of the view itself x, y; radius_px_per_D x, y
  vec4 blur_lens;           // blur radius x, y, displacement x, y for the aperture's centre, px per D
  vec4 focus;               // focus_D, J0, J45, length of the last two
  vec4 acuity;              // gaze x, y, base, per px
  vec4 cut;                 // allowed variance per blur^2, per pixel^2, per acuity^2; near_m
  vec4 background_low_pass;    // linear RGB; standard deviation of the low-pass, px
  vec4 meridian_oblong;        // nearest meridian x, y; lens radii along the image's axes, x, y
  vec4 sub_aperture_shading;   // radius of a sub-aperture, shading, number of sub-apertures;
                               // the lens's radius, metres
  ivec4 size;                  // image width, height, margin, samples may be coarse
  ivec4 cells;                 // columns, rows of the smallest tiles; blurred (1: by a part of the
                               // lens, 2: by all of it), oriented
  ivec4 scene;                 // surfels or Gaussians, levels of nodes, distance along the axis,
                               // has opacity; of Gaussians: low-pass preserves light
  ivec4 room;                  // entries of the cut, of the tile lists, work items;
                               // first node of which all surfels may be taken together
  ivec4 cut_switches;          // `CutSettings::foreshortened`
};

const int kGroup = 8;  // samples along the side of a work group
const int kGroupsASide = (kMostSamples + kGroup - 1) / kGroup;
const float kDisc = kDiscVariancePerRadius2;
const float kWhole = 2.0;  // passed by a node whose surfels all render, at full weight

vec3 unpackNormal(uint bits) {
  vec2 p = vec2(bitfieldExtract(int(bits), 0, 16), bitfieldExtract(int(bits), 16, 16)) / 32767.0;
  float z = 1.0 - abs(p.x) - abs(p.y), fold = max(-z, 0.0);
  vec2 side = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return normalize(vec3(p - side * fold, z));
}

float square(float x) { return x * x; }

vec3 fromEye(vec3 place) { return place - vec3(right.w, up.w, back.w); }
vec3 inEyeAxes(vec3 v) { return vec3(dot(right.xyz, v), dot(up.xyz, v), dot(back.xyz, v)); }

// `Acuity::finest_px` of render/optics/acuity.h.
float finest(float from_gaze) { return max(acuity.z + acuity.w * from_gaze, 1.0); }

// Drivers limit the work groups of a dimension, so those of a dispatch lie in rows. The last row may
// have groups too many: each shader checks its index.
uvec4 rowsOf(uint groups) {
  return uvec4(min(groups, kGroupsARow), (groups + kGroupsARow - 1u) / kGroupsARow, 1u, 0u);
}
uint groupIndex() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint threadIndex(uint group_size) { return groupIndex() * group_size + gl_LocalInvocationIndex; }

int samplesOf(ivec4 tile) { return tile.z / tile.w + (tile.w > 1 ? 2 * kApron : 0); }

// Of 256 threads, `me` is one: its `sums[me]` becomes the sum of those up to its own.
#define SUM_UP(sums, Type)                                 \
  barrier();                                               \
  for (uint step = 1u; step < 256u; step *= 2u) {          \
    Type before = me >= step ? sums[me - step] : Type(0u); \
    barrier();                                             \
    sums[me] += before;                                    \
    barrier();                                             \
  }

// What one stage counts and later stages and the host read. GpuTotals names the same places.
layout(std430, binding = TOTALS_BINDING) buffer Totals {
  uint cut_nodes, cut_entries, cut_whole;  // nodes; all; where whole nodes' surfels begin
  uint nearest, farthest;  // bits of the splats' distances
  uint list_entries;
  uint splats;
  uint work[3];            // work items: unblurred, whole aperture, sub-apertures
  uint fragments_low, fragments_high;
  uint longest_list, sweep_rounds;  // the most of a tile, and of a sample
  uint unused[2];
  uvec4 project_groups;    // numbers of work groups of indirect dispatches
  uvec4 sweep_groups[3];
};
