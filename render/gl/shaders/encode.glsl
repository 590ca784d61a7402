// A view's pixels as 8-bit codes in the texture that a window shows: render/image/srgb.h.
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 0) readonly buffer Image { vec4 pixels[]; };
layout(rgba8, binding = 0) uniform image2D shown;
layout(location = 0) uniform ivec4 place;  // width, height; corner in the texture
layout(location = 1) uniform ivec2 only;   // columns from the left; column of a white line, or -1
layout(location = 2) uniform bvec3 channels;
layout(location = 3) uniform float gamma;  // 0: sRGB

vec3 codesOf(vec3 linear) {
  vec3 light = clamp(linear, 0.0, 1.0);
  if (gamma > 0.0) return pow(light, vec3(1.0 / gamma));
  return mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light,
             lessThanEqual(light, vec3(0.0031308)));
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), to = at + place.zw;
  if (any(greaterThanEqual(at, place.xy)) || at.x >= only.x) return;
  vec3 code = at.x == only.y ? vec3(1.0) : codesOf(pixels[at.y * place.x + at.x].rgb);
  if (!all(channels)) code = mix(imageLoad(shown, to).rgb, code, channels);
  imageStore(shown, to, vec4(code, 1.0));
}
