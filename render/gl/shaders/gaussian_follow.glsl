// The samples of jobs that are followed, for gaussian_composite.glsl: what `ViewSpread` of
// render/gaussians/view_spread.h gathers, as sums over the views.

#ifdef FOLLOW
// Eight vectors each: light of the first view, or of the view that is judged; then of all views less
// that the sums and the sums of products: red; green, blue, rr, rg; rb, gg, gb, bb; the sums times
// each polynomial; of the views, the number and the sum of the transmittances.
layout(std430, binding = 11) buffer Follows { vec4 followed[]; };

// The sample of this job that is nearest to the i-th that is followed along a side (`ViewSpread`).
int followedAt(Job job, int i) {
  int place = job.follow_first + job.follow_apart * i, ratio = job.follow_ratio;
  return ratio == 0 ? place : (2 * place + 1 + ratio) / (2 * ratio);
}

// @param base  light that the sums are less
void followAt(uint at, uint view, uint views, vec4 own[2], vec3 light, float through, vec3 base) {
  if (view == 0u) {
    followed[at] = vec4(base, 0.0);
    for (uint i = 1u; i < 7u; ++i) followed[at + i] = vec4(0.0);
    followed[at + 7u] = vec4(float(views), 0.0, 0.0, 0.0);
  }
  vec3 d = light - followed[at].rgb;
  followed[at].w += d.r;
  followed[at + 1u] += vec4(d.g, d.b, d.r * d.r, d.r * d.g);
  followed[at + 2u] += vec4(d.r * d.b, d.g * d.g, d.g * d.b, d.b * d.b);
  vec4 p = own[1];
  followed[at + 3u] += vec4(own[0].w * d, p.x * d.r);
  followed[at + 4u] += vec4(p.x * d.gb, p.y * d.rg);
  followed[at + 5u] += vec4(p.y * d.b, p.z * d);
  followed[at + 6u] += vec4(p.w * d, 0.0);
  followed[at + 7u].y += through;
}

// @param own   the disc's vectors
// @param seen  of the Gaussians: display values, transmittance
void follow(Job job, ivec2 here, uint view, vec4 own[2], vec4 seen, vec3 background) {
  // Which of those that are followed are here: from `begin` on, before `end`.
  ivec2 begin = ivec2(0), end = ivec2(0);
  for (int i = 0; i < job.along; ++i) {
    int place = followedAt(job, i);
    begin += ivec2(lessThan(ivec2(place), here));
    end += ivec2(lessThanEqual(ivec2(place), here));
  }
  rounds += uint(job.along);
  if (any(equal(begin, end))) return;
  // Over the mean of the views behind, as `ViewSpread::errorsOfMean`.
  Light behind = Light(vec4(background, 0.0), vec4(0.0));
  if (job.mean != kNone) behind = lightBehind(job, here, job.mean);
  vec3 light =
      linearOf(seen.rgb + seen.a * behind.display.rgb) + seen.a * seen.a * behind.light.rgb;
  for (int y = begin.y; y < end.y; ++y) {
    for (int x = begin.x; x < end.x; ++x) {
      uint i = uint(y * job.along + x);
      vec3 base = job.judged == kNone ? light : followed[8u * (job.judged + i)].rgb;
      followAt(8u * (job.followed + i), view, job.discs.y, own, light, seen.a, base);
    }
  }
  rounds += 16u;
}
#endif
