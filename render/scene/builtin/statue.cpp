// A stone lion on its plinth, in place of the paper's scan, with as many surfels. It is an implicit
// solid of smooth shapes that blend into each other, organic and full of folds.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "render/scene/builtin/pattern.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/sampling/implicit_surface.h"

namespace foci {
namespace {

const SolidBounds kBounds{{-0.34f, -0.02f, -0.48f}, {0.34f, 1.10f, 0.46f}, 0.009f};

/// Distance of an ellipsoid, to first order near it.
float ellipsoid(const glm::vec3& p, const glm::vec3& center, const glm::vec3& radii) {
  const glm::vec3 q = (p - center) / radii;
  const float k0 = glm::length(q), k1 = glm::length(q / radii);
  return k1 > 0.0f ? k0 * (k0 - 1.0f) / k1 : -std::min({radii.x, radii.y, radii.z});
}

/// A limb from `a` to `b`, its radius changing from `ra` to `rb`.
float limb(const glm::vec3& p, const glm::vec3& a, float ra, const glm::vec3& b, float rb) {
  const glm::vec3 along = b - a;
  const float t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0f, 1.0f);
  return glm::length(p - a - t * along) - glm::mix(ra, rb, t);
}

float roundedBox(const glm::vec3& p, const glm::vec3& center, const glm::vec3& half, float round) {
  const glm::vec3 q = glm::abs(p - center) - half + round;
  return glm::length(glm::max(q, 0.0f)) + std::min(std::max({q.x, q.y, q.z}), 0.0f) - round;
}

/// Union whose seam is a fillet of about `width`, smooth to the second derivative.
float blend(float a, float b, float width) {
  const float h = std::max(width - std::abs(a - b), 0.0f) / width;
  return std::min(a, b) - h * h * h * width / 6.0f;
}

float carve(float solid, float tool, float width) { return -blend(-solid, tool, width); }

/// Rows of curls, -1 to 1.
float curls(const glm::vec3& p) {
  const float sway = std::sin(26.0f * p.y + 4.0f * p.z);
  return std::sin(52.0f * p.x + 2.0f * sway) * std::sin(58.0f * p.y + 30.0f * p.z + 1.5f * sway);
}

/// The lion is mirrored: `q` is the point with |x|.
float bodyOf(const glm::vec3& p, const glm::vec3& q) {
  float body = limb(p, {0, 0.36f, -0.10f}, 0.17f, {0, 0.62f, 0.08f}, 0.14f);
  body = blend(body, ellipsoid(p, {0, 0.33f, -0.14f}, {0.17f, 0.19f, 0.20f}), 0.10f);
  body = blend(body, ellipsoid(p, {0, 0.55f, 0.13f}, {0.145f, 0.17f, 0.12f}), 0.08f);
  body = blend(body, ellipsoid(q, {0.16f, 0.30f, -0.14f}, {0.10f, 0.17f, 0.18f}), 0.05f);
  body = blend(body, ellipsoid(q, {0.125f, 0.54f, 0.10f}, {0.07f, 0.13f, 0.09f}), 0.05f);
  const float leg = limb(q, {0.125f, 0.52f, 0.15f}, 0.065f, {0.13f, 0.21f, 0.20f}, 0.048f);
  body = blend(body, leg, 0.04f);
  float paws = ellipsoid(q, {0.13f, 0.195f, 0.235f}, {0.062f, 0.048f, 0.085f});
  paws = blend(paws, ellipsoid(q, {0.205f, 0.185f, 0.06f}, {0.055f, 0.042f, 0.12f}), 0.03f);
  for (int toe = 0; toe < 4; ++toe) {
    const float side = 0.026f * (static_cast<float>(toe) - 1.5f);
    const float back = 0.008f * std::abs(static_cast<float>(toe) - 1.5f);
    paws =
        blend(paws, ellipsoid(q, {0.13f + side, 0.186f, 0.308f - back}, {0.016f, 0.028f, 0.034f}),
              0.012f);
    paws =
        blend(paws, ellipsoid(q, {0.205f + side, 0.180f, 0.165f - back}, {0.016f, 0.024f, 0.03f}),
              0.012f);
  }
  return blend(body, paws, 0.03f);
}

float tailOf(const glm::vec3& p) {
  float tail = limb(p, {0, 0.26f, -0.32f}, 0.05f, {0, 0.50f, -0.37f}, 0.06f);
  tail = blend(tail, limb(p, {0, 0.50f, -0.37f}, 0.075f, {0, 0.80f, -0.33f}, 0.02f), 0.08f);
  return tail + 0.008f * curls(p);
}

float headOf(const glm::vec3& p, const glm::vec3& q) {
  float mane = ellipsoid(p, {0, 0.76f, 0.05f}, {0.205f, 0.215f, 0.165f});
  mane = blend(mane, ellipsoid(p, {0, 0.66f, 0.14f}, {0.15f, 0.13f, 0.10f}), 0.08f);
  mane += 0.010f * curls(p);

  float face = ellipsoid(p, {0, 0.86f, 0.155f}, {0.14f, 0.14f, 0.135f});
  face = blend(face, ellipsoid(p, {0, 0.815f, 0.26f}, {0.085f, 0.06f, 0.075f}), 0.05f);  // muzzle
  face = blend(face, ellipsoid(q, {0.095f, 0.825f, 0.215f}, {0.05f, 0.05f, 0.05f}), 0.04f);
  face = blend(face, ellipsoid(p, {0, 0.735f, 0.245f}, {0.072f, 0.036f, 0.075f}), 0.03f);  // jaw
  face = carve(face, ellipsoid(p, {0, 0.770f, 0.315f}, {0.078f, 0.017f, 0.09f}), 0.015f);  // mouth
  face = blend(face, ellipsoid(q, {0.036f, 0.803f, 0.318f}, {0.04f, 0.028f, 0.032f}), 0.015f);
  face = blend(face, ellipsoid(p, {0, 0.848f, 0.325f}, {0.036f, 0.026f, 0.03f}), 0.02f);  // nose
  face = carve(face, ellipsoid(q, {0.017f, 0.838f, 0.352f}, {0.009f, 0.008f, 0.012f}), 0.006f);
  face = carve(face, ellipsoid(q, {0.064f, 0.884f, 0.278f}, {0.038f, 0.027f, 0.03f}), 0.02f);
  face = blend(face, ellipsoid(q, {0.062f, 0.884f, 0.255f}, {0.026f, 0.024f, 0.024f}), 0.006f);
  face = blend(face, ellipsoid(q, {0.066f, 0.922f, 0.258f}, {0.052f, 0.022f, 0.035f}), 0.02f);
  face = blend(face, ellipsoid(p, {0, 0.985f, 0.11f}, {0.06f, 0.05f, 0.10f}), 0.06f);  // crown
  float ears = ellipsoid(q, {0.135f, 0.955f, 0.115f}, {0.034f, 0.062f, 0.026f});
  ears = carve(ears, ellipsoid(q, {0.137f, 0.960f, 0.150f}, {0.018f, 0.040f, 0.022f}), 0.012f);
  return blend(blend(mane, face, 0.03f), ears, 0.025f);
}

float plinthOf(const glm::vec3& p) {
  float plinth = roundedBox(p, {0, 0.075f, -0.04f}, {0.28f, 0.075f, 0.37f}, 0.018f);
  // A groove all around, and a row of dimples below it.
  const float height = (p.y - 0.112f) / 0.010f;
  plinth += 0.009f * std::exp(-height * height);
  const float row = (p.y - 0.055f) / 0.03f, along = std::sin(60.0f * p.x) * std::sin(60.0f * p.z);
  return plinth + 0.004f * std::exp(-row * row) * along;
}

float lion(const glm::vec3& p) {
  const glm::vec3 q(std::abs(p.x), p.y, p.z);
  float solid = blend(bodyOf(p, q), headOf(p, q), 0.06f);
  solid = blend(solid, tailOf(p), 0.05f);
  return blend(solid, plinthOf(p), 0.02f);
}

/// Fractal noise in space, 0 to 1: the mean of noise on the three planes, weighted by the normal.
float stoneNoise(const glm::vec3& p, const glm::vec3& normal, float per_m, int octaves,
                 std::int32_t seed) {
  const glm::vec3 share = normal * normal, at = per_m * p + 100.0f;
  return share.x * fractalNoise({at.y, at.z}, octaves, seed) +
         share.y * fractalNoise({at.x, at.z}, octaves, seed + 11) +
         share.z * fractalNoise({at.x, at.y}, octaves, seed + 23);
}

/// Granite, weathered: grains as fine as the samples, veins, lichen, water stains; eyes of gold and
/// a red mouth, worn.
glm::vec3 paint(const glm::vec3& p, const glm::vec3& normal) {
  const float grain = stoneNoise(p, normal, 160.0f, 2, 3);
  const float cloud = stoneNoise(p, normal, 9.0f, 4, 5);
  glm::vec3 color = glm::mix(srgb(0x77716a), srgb(0xc9c0b0), glm::smoothstep(0.25f, 0.75f, grain));
  color *= 0.65f + 0.6f * cloud;
  const float vein = std::abs(stoneNoise(p, normal, 14.0f, 4, 7) - 0.5f);
  color = glm::mix(srgb(0x4a3f38), color, glm::smoothstep(0.004f, 0.022f, vein));
  const float lichen = glm::smoothstep(0.56f, 0.62f, stoneNoise(p, normal, 22.0f, 4, 13)) *
                       glm::smoothstep(-0.3f, 0.5f, normal.y);
  color = glm::mix(color, glm::mix(srgb(0xb58a2c), srgb(0x8f9a5a), grain), 0.8f * lichen);
  const float streak = stoneNoise({p.x, 0.06f * p.y, p.z}, normal, 70.0f, 2, 17);
  color *= glm::mix(1.0f, 0.55f + 0.45f * glm::smoothstep(0.35f, 0.6f, streak),
                    1.0f - std::abs(normal.y));

  const glm::vec3 q(std::abs(p.x), p.y, p.z);
  const float worn = glm::smoothstep(0.3f, 0.6f, stoneNoise(p, normal, 60.0f, 3, 19));
  const float eye = ellipsoid(q, {0.062f, 0.884f, 0.255f}, {0.026f, 0.024f, 0.024f});
  if (eye < 0.001f) {
    const float pupil = glm::length(glm::vec2(q.x - 0.066f, q.y - 0.884f));
    color = glm::mix(srgb(0x1a1512), srgb(0xd9a632), glm::smoothstep(0.008f, 0.010f, pupil));
  }
  const float mouth = ellipsoid(p, {0, 0.770f, 0.315f}, {0.078f, 0.017f, 0.09f});
  return glm::mix(color, srgb(0x9c2f26),
                  (0.4f + 0.6f * worn) * glm::smoothstep(0.006f, 0.0f, mouth));
}

/// Share of a lamp's light that reaches a point. The shadow is soft: sphere tracing finds the
/// nearest miss over the distance (Quilez).
float lamp(const glm::vec3& p, const glm::vec3& towards) {
  float light = 1.0f, t = 0.012f;
  for (int step = 0; step < 40 && t < 1.2f; ++step) {
    const float free_m = lion(p + t * towards);
    light = std::min(light, 9.0f * free_m / t);
    if (light <= 0.0f) return 0.0f;
    t += std::clamp(0.8f * free_m, 0.006f, 0.1f);
  }
  return glm::smoothstep(0.0f, 1.0f, light);
}

glm::vec3 shade(const glm::vec3& p, const glm::vec3& normal, const glm::vec3& color) {
  float open = 1.0f, weight = 1.0f;  // how open the surroundings are
  for (int i = 1; i <= 5; ++i, weight *= 0.6f) {
    const float out_m = 0.014f * static_cast<float>(i);
    open -= weight * std::max(0.0f, out_m - lion(p + out_m * normal)) / 0.06f;
  }
  open = std::max(open, 0.08f);
  const glm::vec3 sun = glm::normalize(glm::vec3(0.75f, 0.9f, 0.8f));
  const float facing = std::max(glm::dot(normal, sun), 0.0f);
  const glm::vec3 sky = glm::mix(srgb(0x6e6152), srgb(0xa9bdd6), 0.5f + 0.5f * normal.y);
  const glm::vec3 start = p + 0.004f * normal;
  const float direct = facing > 0.0f ? facing * lamp(start, sun) : 0.0f;
  return glm::min(color * (0.75f * open * sky + 1.05f * direct * srgb(0xfff1da)), 1.0f);
}

}  // namespace

SurfelCloud makeStatue() {
  SolidSamples samples = sampleSolid(lion, kBounds, kStatueSurfels);
  PointCloud points;
  points.color.resize(samples.position_m.size());
  parallelFor(points.color.size(), [&](std::size_t i) {
    const glm::vec3 &p = samples.position_m[i], &normal = samples.normal[i];
    points.color[i] = shade(p, normal, paint(p, normal));
  });
  points.position_m = std::move(samples.position_m);
  points.normal = std::move(samples.normal);
  points.body.assign(points.size(), 1);  // the level set of a distance is closed
  SurfelCloud cloud = surfelsFromPoints(std::move(points));
  cloud.oriented = true;
  return cloud;
}

EyePose statueEyePose() { return {{0.90f, 1.05f, 1.95f}, {0.02f, 0.47f, -0.02f}}; }

}  // namespace foci
