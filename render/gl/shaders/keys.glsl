// What project.glsl and gaussian_project.glsl share: keys, by which later stages order splats and
// list them in tiles. One thread an entry.
layout(local_size_x = 64) in;
layout(std430, binding = 5) writeonly buffer Keys { uvec4 keys[]; };

// Of the work group: bits of the splats' distances, and how many there are.
shared uint near_bits, far_bits, splat_count;


// The logarithm of `stepFor` of render/splat/bin.cpp.
uint log2StepFor(float sigma_px) {
  uint log2_step = 3u;
  while (log2_step > 0u && !(sigma_px >= kSigmasAStep * float(1u << log2_step))) --log2_step;
  return log2_step;
}

void writeNoKey(uint slot) { keys[slot] = uvec4(0u, 1u, 0u, 0u); }  // x0 > x1: nothing to render

// @param low, high  pixels of the box, inclusive
void writeKey(uint slot, float distance_m, uvec2 low, uvec2 high, uint log2_step, float blur_px) {
  uint bits = floatBitsToUint(distance_m);
  keys[slot] = uvec4(bits, low.x | high.x << 15 | log2_step << 30, low.y | high.y << 15,
                     floatBitsToUint(blur_px));
  atomicMin(near_bits, bits);
  atomicMax(far_bits, bits);
  atomicAdd(splat_count, 1u);
}

// Projects an entry, and writes its key or none.
void projectEntry(uint slot);

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    near_bits = kNone;
    far_bits = splat_count = 0u;
  }
  barrier();
  uint slot = threadIndex(64u);
  if (slot < min(cut_entries, uint(room.x))) projectEntry(slot);
  barrier();
  if (gl_LocalInvocationIndex != 0u || splat_count == 0u) return;
  if (near_bits < nearest) atomicMin(nearest, near_bits);
  if (far_bits > farthest) atomicMax(farthest, far_bits);
  atomicAdd(splats, splat_count);
}
