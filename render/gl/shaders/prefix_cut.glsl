// Prefix sums over the work groups of gather.glsl, by one work group.
layout(local_size_x = 256) in;
layout(std430, binding = 2) buffer Sums { uvec4 sums[]; };
layout(location = 0) uniform uint sum_count;
shared uvec4 parts[256];

void main() {
  uint me = gl_LocalInvocationID.x, each = (sum_count + 255u) / 256u;
  uint first = min(me * each, sum_count), end = min(first + each, sum_count);
  uvec4 mine = uvec4(0u);
  for (uint i = first; i < end; ++i) mine += sums[i];
  parts[me] = mine;
  SUM_UP(parts, uvec4)
  uvec4 running = parts[me] - mine;
  for (uint i = first; i < end; ++i) {
    uvec4 count = sums[i];
    sums[i] = running;
    running += count;
  }
  if (me != 255u) return;
  cut_nodes = running.x;
  cut_whole = running.x + running.y;
  cut_entries = cut_whole + running.z;
  project_groups = rowsOf((min(cut_entries, uint(room.x)) + 63u) / 64u);
}
