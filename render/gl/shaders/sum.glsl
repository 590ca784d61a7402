// Adds a share of one image to another; or, with REPLACES, replaces it.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer From { vec4 from[]; };
layout(std430, binding = 1) buffer To { vec4 to[]; };
layout(location = 0) uniform vec4 share;
layout(location = 1) uniform uint pixels;

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 256u + gl_LocalInvocationID.x;
  if (i >= pixels) return;
  precise vec4 value = share * from[i];  // as the CPU rounds: no fused operations
#ifndef REPLACES
  value = to[i] + value;
#endif
  to[i] = value;
}
