// Prefix sums over the work groups of gather.glsl, by one work group.
layout(local_size_x = 256) in;
layout(std430, binding = 2) buffer Sums { uvec2 sums[]; };
layout(location = 0) uniform uint sum_count;
shared uvec2 parts[256];

void main() {
  uint me = gl_LocalInvocationID.x, each = (sum_count + 255u) / 256u;
  uint first = min(me * each, sum_count), end = min(first + each, sum_count);
  uvec2 mine = uvec2(0u);
  for (uint i = first; i < end; ++i) mine += sums[i];
  parts[me] = mine;
  barrier();
  for (uint step = 1u; step < 256u; step *= 2u) {
    uvec2 before = me >= step ? parts[me - step] : uvec2(0u);
    barrier();
    parts[me] += before;
    barrier();
  }
  uvec2 running = parts[me] - mine;
  for (uint i = first; i < end; ++i) {
    uvec2 count = sums[i];
    sums[i] = running;
    running += count;
  }
  if (me != 255u) return;
  cut_nodes = running.x;
  cut_entries = running.x + running.y;
  project_groups = uvec4((min(cut_entries, uint(room.x)) + 63u) / 64u, 1u, 1u, 0u);
}
