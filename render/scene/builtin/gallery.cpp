// The gallery: the places and the paint of its exhibits. Lamps and shadows are in gallery_light.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "render/scene/builtin/gallery_stage.h"
#include "render/scene/builtin/pattern.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

using glm::vec2;

constexpr float kTable_m = 1.22f;

// The built-in study's screen: 1280 pixels, 0.5 m wide, 0.6 m away.
constexpr float kFocal_px = 1536.0f;
const glm::vec2 kHalfView{0.417f, 0.234f};

const glm::vec3 kEye{0.0f, 1.45f, 0.0f};
const glm::vec3 kLookAt{0.0f, 1.31f, -2.0f};
const glm::vec3 kKnot{-0.185f, kTable_m + 0.175f, -1.12f};
const glm::vec3 kBall{0.015f, kTable_m + 0.042f, -0.86f};
const glm::vec3 kMask{0.118f, 1.395f, -1.36f};
const glm::vec3 kBust{0.25f, 1.545f, -1.95f};
const glm::vec3 kVase{-0.80f, 1.02f, -3.2f};
const glm::vec3 kSpheres{0.95f, 1.0f, -4.3f};

glm::vec3 marble(const glm::vec3& p, const glm::vec3& base, const glm::vec3& vein, float scale) {
  const glm::vec2 q = scale * glm::vec2(p.x + 0.6f * p.y, p.z - 0.5f * p.y);
  const float warp = fractalNoise(q * 3.0f + 100.0f, 5, 31);
  const float line = std::abs(std::sin(6.0f * q.x + 2.0f * q.y + 9.0f * warp));
  const float thin = std::pow(1.0f - line, 6.0f);
  const float grain = fractalNoise(q * 90.0f + 50.0f, 2, 37);
  return glm::mix(base, vein, 0.75f * thin + 0.25f * warp * warp) * (0.88f + 0.24f * grain);
}

void addTable(GalleryStage& stage) {
  const glm::vec3 corner{-0.46f, kTable_m, -0.55f};
  const Paint stone = [](const SurfacePoint& at) {
    const glm::vec2 p = glm::vec2(at.p_world.x, at.p_world.z) / 0.115f;
    const glm::vec3 light = marble(at.p_world, srgb(0xe9e3d8), srgb(0x8d8579), 4.0f);
    const glm::vec3 dark = marble(at.p_world, srgb(0x3c4a4f), srgb(0xb9b39f), 5.0f);
    const glm::vec2 inside = glm::abs(p - glm::round(p));
    const glm::vec2 middle = glm::abs(p - glm::floor(p) - 0.5f);
    const float inlay = middle.x + middle.y < 0.22f ? 1.0f : 0.0f;
    const glm::vec3 tile = glm::mix(checker(p) > 0.5f ? dark : light,
                                    checker(p) > 0.5f ? srgb(0xc79a4b) : srgb(0x8a3b32), inlay);
    return glm::mix(tile, srgb(0x6b6257), std::min(inside.x, inside.y) < 0.02f ? 0.8f : 0.0f);
  };
  stage.add(rectangle(corner, {0.92f, 0, 0}, {0, 0, -1.75f}), stone,
            {.gloss = 0.10f, .hardness = 90.0f});
}

/// Things from 0.25 to 0.5 m: a plant on the left, brass lattice on the right.
void addForeground(GalleryStage& stage) {
  const auto green = [](std::int32_t seed) {
    return [seed](const SurfacePoint& at) {
      const float across = std::abs(2.0f * at.uv.x - 1.0f);
      const float rib = 1.0f - glm::smoothstep(0.03f, 0.09f, across);
      const float veins = lines(at.uv.y * 11.0f - across * 2.2f, 0.07f);
      const float blotch = fractalNoise({at.uv.x * 14.0f, at.uv.y * 34.0f}, 4, seed);
      const glm::vec3 blade = glm::mix(srgb(0x2b5e2a), srgb(0x78a63c), blotch);
      return glm::mix(blade, srgb(0xc4d98b), std::min(0.8f * rib + 0.45f * veins, 1.0f));
    };
  };
  const Material waxy{
      .gloss = 0.10f, .hardness = 25.0f, .shadowed = false, .two_sided = true, .coarse = 1.3f};
  for (int stem = 0; stem < 3; ++stem) {
    const auto k = static_cast<float>(stem);
    const glm::vec3 foot(-0.128f + 0.019f * k, 1.30f, -0.27f - 0.028f * k);
    const float lean = 0.045f - 0.027f * k + 0.02f * hash01(stem, 1, 5), tall = 0.215f - 0.018f * k;
    const Curve curve = [=](float t) {
      return foot + glm::vec3(lean * t * t - 0.012f * std::sin(4.0f * t), tall * t, 0.02f * t * t);
    };
    stage.add(
        tube(curve, [](float t) { return 0.0016f * (1.1f - 0.7f * t); }, {0, 0, 1}),
        [](const SurfacePoint& at) {
          return glm::mix(srgb(0x4d7a2f), srgb(0x7b4b2e), 0.5f * lines(at.uv.y * 40.0f, 0.1f));
        },
        waxy);
    for (int i = 0; i < 4; ++i) {
      const float t = 0.2f + 0.24f * static_cast<float>(i);
      const float turn = 2.4f * static_cast<float>(i) + 1.3f * k;
      const float length = 0.036f + 0.018f * hash01(stem, i, 9);
      const glm::vec3 out(std::cos(turn), 0.45f, 0.55f * std::sin(turn));
      const glm::vec3 side = glm::normalize(glm::cross(out, glm::vec3(0.15f, 0.5f, 1.0f)));
      stage.add(leaf(curve(t), length * out, 0.30f * length * side, 0.4f * length),
                green(stem * 7 + i), waxy);
    }
  }

  const Paint brass = [](const SurfacePoint& at) {
    const float twist = std::sin(glm::two_pi<float>() * (at.uv.x + at.uv.y * 38.0f));
    return srgb(0xd6a648) * (0.75f + 0.25f * twist);
  };
  const Material metal{.gloss = 0.5f, .hardness = 30.0f, .shadowed = false};
  const auto wire = [&](const glm::vec3& a, const glm::vec3& b, float radius) {
    const float end = radius / glm::distance(a, b);  // rounds the ends
    const auto radiusAt = [=](float t) {
      const float in = std::min(1.0f, std::min(t, 1.0f - t) / end);
      return radius * std::sqrt(std::max(in * (2.0f - in), 0.0f));
    };
    stage.addClosed(tube([=](float t) { return glm::mix(a, b, t); }, radiusAt, {0, 0, 1}), brass,
                    metal);
  };
  const float left = 0.108f, right = 0.25f, low = 1.27f, high = 1.56f, depth = -0.46f;
  wire({left, low, depth}, {left, high, depth}, 0.0028f);
  for (int i = 0; i < 12; ++i) {
    const float at = low - 0.14f + 0.036f * static_cast<float>(i);
    const auto clipped = [&](float slope, float start, float z) {
      // From the bar to the right edge, cut at the top.
      const glm::vec3 a(left, start, z), b(right, start + slope * (right - left), z);
      const float t0 = std::clamp((low - a.y) / (b.y - a.y), 0.0f, 1.0f);
      const float t1 = std::clamp((high - a.y) / (b.y - a.y), 0.0f, 1.0f);
      const float from = std::min(t0, t1), to = slope > 0.0f ? t1 : t0;
      const float begin = slope > 0.0f ? t0 : std::min(t1, from);
      if (to - begin > 0.05f) wire(glm::mix(a, b, begin), glm::mix(a, b, to), 0.0009f);
    };
    clipped(1.0f, at, depth);
    clipped(-1.0f, at + 0.14f, depth - 0.002f);
  }
}

void addTableExhibits(GalleryStage& stage) {
  stage.addOccluder(kBall, 0.042f);
  stage.addClosed(
      ball(kBall, 0.042f),
      [](const SurfacePoint& at) {
        const glm::vec2 p(at.uv.x * 16.0f, at.uv.y * 8.0f);
        const glm::vec3 tint = checker(p) > 0.5f ? srgb(0xf2ead8) : srgb(0xb5352b);
        return tint *
               (0.8f + 0.4f * fractalNoise(glm::vec2(at.uv.x * 2.0f, at.uv.y) * 90.0f, 3, 91));
      },
      {.gloss = 0.45f, .hardness = 120.0f});
  for (int i = 0; i < 7; ++i) {
    const float radius = 0.009f + 0.008f * hash01(i, 0, 97);
    const glm::vec3 center(-0.30f + 0.62f * hash01(i, 1, 97), kTable_m + radius,
                           -0.80f - 0.36f * hash01(i, 2, 97));
    if (glm::length(center - kBall) < 0.075f ||
        glm::length(glm::vec2(center.x - kKnot.x, center.z - kKnot.z)) < 0.12f)
      continue;
    stage.addOccluder(center, radius);
    stage.addClosed(ball(center, radius),
                    [i](const SurfacePoint& at) {
                      const float swirl =
                          std::sin(9.0f * at.uv.y + glm::two_pi<float>() * 2.0f * at.uv.x +
                                   5.0f * static_cast<float>(i));
                      return glm::mix(srgb(i % 2 == 0 ? 0x2a7f9e : 0x8e3b8a), srgb(0xf6e7c1),
                                      glm::smoothstep(0.1f, 0.4f, swirl));
                    },
                    {.gloss = 0.6f, .hardness = 150.0f});
  }

  // The knot on its plinth.
  const Curve knot = torusKnot(kKnot, 0.062f, 2, 3);
  for (int i = 0; i < 20; ++i) stage.addOccluder(knot(static_cast<float>(i) / 20.0f), 0.019f);
  stage.addClosed(
      tube(knot, [](float) { return 0.021f; }, {0, 0, 1}),
      [](const SurfacePoint& at) {
        const float spiral = at.uv.x * 3.0f + at.uv.y * 42.0f;
        const float band =
            glm::smoothstep(0.40f, 0.46f, std::abs(spiral - std::floor(spiral) - 0.5f) * 2.0f);
        const float fine = lines(at.uv.y * 336.0f, 0.12f);
        const glm::vec3 blue = glm::mix(srgb(0x1d4e89), srgb(0x8fc1e3), 0.5f * fine);
        return glm::mix(blue, srgb(0xf4a259), band) *
               (0.85f + 0.3f * fractalNoise({at.uv.x * 24.0f, at.uv.y * 500.0f}, 2, 101));
      },
      {.gloss = 0.4f, .hardness = 70.0f});
  const glm::vec3 plinth(kKnot.x, kTable_m, kKnot.z);
  stage.addOccluder(plinth + glm::vec3(0, 0.02f, 0), 0.05f);
  stage.addClosed(lathe(plinth, {vec2(0.0f, 0.0f), vec2(0.070f, 0.0f), vec2(0.070f, 0.012f),
                                 vec2(0.058f, 0.020f), vec2(0.048f, 0.045f), vec2(0.052f, 0.060f),
                                 vec2(0.0f, 0.061f)}),
                  [](const SurfacePoint& at) {
                    return marble(at.p_world, srgb(0x2c2b2e), srgb(0xd8c9a8), 9.0f);
                  },
                  {.gloss = 0.25f, .hardness = 80.0f});
}

/// A bust, and the half-transparent mask before it.
void addFigure(GalleryStage& stage) {
  const float scale = 1.35f;
  const Paint stone = [](const SurfacePoint& at) {
    return marble(at.p_world, srgb(0xede4d3), srgb(0x9a8468), 6.0f);
  };
  const Material polished{.gloss = 0.10f, .hardness = 35.0f};
  stage.addOccluder(kBust, 0.115f);
  stage.addOccluder(kBust + glm::vec3(0, -0.27f, 0), 0.13f);
  stage.addClosed(
      head(kBust, scale, {-glm::pi<float>(), glm::pi<float>()}, {-1.5707f, 1.5707f}, true), stone,
      polished);
  const Shape trunk = lathe(
      {0, 0, 0}, {vec2(0.0f, 0.0f), vec2(0.075f, 0.0f), vec2(0.078f, 0.012f), vec2(0.05f, 0.024f),
                  vec2(0.042f, 0.045f), vec2(0.075f, 0.075f), vec2(0.118f, 0.115f),
                  vec2(0.142f, 0.155f), vec2(0.138f, 0.18f), vec2(0.098f, 0.203f),
                  vec2(0.066f, 0.225f), vec2(0.060f, 0.29f), vec2(0.0f, 0.29f)});
  stage.addClosed(
      [trunk](glm::vec2 uv) {
        const glm::vec3 p = trunk(uv);
        const float wide =
            1.0f + 0.2f * glm::smoothstep(0.05f, 0.12f, p.y) * glm::smoothstep(0.21f, 0.17f, p.y);
        return glm::vec3(kBust.x, kTable_m, kBust.z) + glm::vec3(p.x * wide, p.y, p.z * 0.8f);
      },
      stone, polished);

  const glm::vec2 azimuth{-1.15f, 1.15f}, elevation{-0.78f, 0.72f};
  stage.add(
      head(kMask, 1.02f, azimuth, elevation, false),
      [=](const SurfacePoint& at) {
        const float a = glm::mix(azimuth.x, azimuth.y, at.uv.x),
                    e = glm::mix(elevation.x, elevation.y, at.uv.y);
        const float scroll = std::sin(26.0f * e + 7.0f * std::sin(5.0f * std::abs(a)));
        const float filigree = glm::smoothstep(0.55f, 0.8f, std::abs(scroll));
        const glm::vec3 ground = a < 0.0f ? srgb(0xc9263b) : srgb(0x1f6f8b);
        const glm::vec3 gold = srgb(0xf7cf6b);
        const float brow = std::exp(-80.0f * std::pow(e - 0.33f - 0.12f * std::abs(a), 2.0f));
        return glm::mix(glm::mix(ground, gold, 0.8f * filigree), gold, brow);
      },
      {.gloss = 0.25f, .hardness = 30.0f, .shadowed = false, .two_sided = true}, 0.6f,
      [=](const SurfacePoint& at) {
        const float a = std::abs(glm::mix(azimuth.x, azimuth.y, at.uv.x)),
                    e = glm::mix(elevation.x, elevation.y, at.uv.y);
        const float eye = std::pow((a - 0.36f) / 0.17f, 2.0f) +
                          std::pow((e - 0.11f - 0.12f * (a - 0.36f)) / 0.075f, 2.0f);
        const float mouth = std::pow(a / 0.26f, 2.0f) + std::pow((e + 0.535f) / 0.035f, 2.0f);
        const float rim =
            std::pow(a / 1.15f, 2.0f) + std::pow(e / (e > 0.0f ? 0.72f : 0.78f), 2.0f);
        return eye > 1.0f && mouth > 1.0f && rim < 1.0f;
      });
  // The mask's stand.
  const glm::vec3 foot(kMask.x, kTable_m, kMask.z + 0.02f);
  const Paint brass = [](const SurfacePoint&) { return srgb(0xc79a4b); };
  stage.addOccluder(foot, 0.035f);
  stage.addClosed(
      lathe(foot, {vec2(0.0f, 0.0f), vec2(0.040f, 0.0f), vec2(0.038f, 0.004f), vec2(0.012f, 0.010f),
                   vec2(0.0035f, 0.02f), vec2(0.0025f, 0.10f), vec2(0.0f, 0.10f)}),
      brass, {.gloss = 0.4f, .hardness = 40.0f});
}

/// On pedestals behind the table: a fluted vase, a pile of spheres.
void addPedestals(GalleryStage& stage) {
  const Paint plaster = [](const SurfacePoint& at) {
    return srgb(0xcfc6b8) *
           (0.8f + 0.3f * fractalNoise({at.uv.x * 60.0f, at.p_world.y * 60.0f}, 4, 107));
  };
  for (const glm::vec3& top : {kVase, kSpheres}) {
    stage.addOccluder(top - glm::vec3(0, 0.2f, 0), 0.2f);
    stage.addClosed(lathe({top.x, 0.0f, top.z},
                          {vec2(0.0f, 0.35f), vec2(0.26f, 0.35f), vec2(0.20f, 0.45f),
                           vec2(0.19f, top.y - 0.12f), vec2(0.21f, top.y - 0.08f),
                           vec2(0.25f, top.y - 0.04f), vec2(0.25f, top.y), vec2(0.0f, top.y)},
                          16, 0.08f),
                    plaster, {.gloss = 0.02f, .coarse = 2.0f});
  }
  stage.addOccluder(kVase + glm::vec3(0, 0.24f, 0), 0.16f);
  stage.addOccluder(kVase + glm::vec3(0, 0.45f, 0), 0.07f);
  stage.addClosed(
      lathe(kVase,
            {vec2(0.0f, 0.0f), vec2(0.085f, 0.0f), vec2(0.09f, 0.02f), vec2(0.06f, 0.05f),
             vec2(0.12f, 0.15f), vec2(0.175f, 0.27f), vec2(0.15f, 0.38f), vec2(0.065f, 0.46f),
             vec2(0.06f, 0.52f), vec2(0.10f, 0.56f), vec2(0.0f, 0.56f)}),
      [](const SurfacePoint& at) {
        const float y = at.p_world.y - kVase.y, turn = at.uv.x;
        const float meander = checker({turn * 48.0f + std::floor(y * 80.0f) * 0.5f, y * 80.0f});
        const bool band = std::abs(y - 0.40f) < 0.025f || std::abs(y - 0.12f) < 0.025f;
        const float flower =
            std::cos(10.0f * glm::two_pi<float>() * turn) * std::cos(34.0f * (y - 0.26f));
        const glm::vec3 white = srgb(0xeef2f3), cobalt = srgb(0x1c3f94);
        const float ink = band ? meander
                               : glm::smoothstep(0.25f, 0.35f, std::abs(flower)) *
                                     (std::abs(flower) < 0.75f ? 1.0f : 0.2f);
        return glm::mix(white, cobalt, ink) *
               (0.9f + 0.2f * fractalNoise({turn * 200.0f, y * 150.0f}, 2, 109));
      },
      {.gloss = 0.4f, .hardness = 90.0f});
  const std::array<glm::vec4, 4> pile{{{-0.11f, 0.11f, 0.05f, 0.11f},
                                       {0.12f, 0.10f, 0.04f, 0.10f},
                                       {0.01f, 0.09f, 0.21f, 0.085f},
                                       {0.0f, 0.27f, 0.06f, 0.11f}}};
  const std::array<glm::vec3, 4> tints{srgb(0xe0a030), srgb(0x3b8c88), srgb(0xb23a48),
                                       srgb(0xe9e4d4)};
  for (std::size_t i = 0; i < pile.size(); ++i) {
    const glm::vec3 center = kSpheres + glm::vec3(pile[i]);
    stage.addOccluder(center, pile[i].w);
    stage.addClosed(
        ball(center, pile[i].w),
        [tint = tints[i], i](const SurfacePoint& at) {
          const float stripe = lines(at.uv.y * 14.0f + (i % 2 == 0 ? 0.0f : at.uv.x * 8.0f), 0.12f);
          return glm::mix(tint, srgb(0x1d1d24), 0.75f * stripe) *
                 (0.85f + 0.3f * fractalNoise({at.uv.x * 80.0f, at.uv.y * 40.0f}, 3, 113));
        },
        {.gloss = 0.35f, .hardness = 80.0f});
  }
}

}  // namespace

SurfelCloud makeGallery(float step_px) {
  const glm::vec3 forward = glm::normalize(kLookAt - kEye);
  const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0.0f, 1.0f, 0.0f)));
  GalleryStage stage({.eye_m = kEye,
                      .right = right,
                      .up = glm::cross(right, forward),
                      .forward = forward,
                      .half_view = kHalfView,
                      .step_rad = step_px / kFocal_px});
  addForeground(stage);
  addTableExhibits(stage);
  addFigure(stage);
  addPedestals(stage);
  addTable(stage);
  addRoom(stage);
  return stage.take();
}

EyePose galleryEyePose() { return {kEye, kLookAt}; }

std::vector<PointOfInterest> galleryPointsOfInterest() {
  return {{"leaf", {-0.078f, 1.441f, -0.291f}},
          {"lattice", {0.109f, 1.420f, -0.460f}},
          {"ball", kBall + glm::vec3(0.0f, 0.01f, 0.0408f)},
          {"knot", kKnot + glm::vec3(0.06f, 0.06f, 0.02f)},
          {"mask", kMask + glm::vec3(-0.03f, -0.03f, 0.09f)},
          {"bust", kBust + glm::vec3(0.03f, 0.02f, 0.13f)},
          {"vase", {-0.793f, 1.546f, -3.136f}},
          {"spheres", {0.800f, 1.127f, -4.153f}},
          {"landscape", {-0.25f, 1.63f, kEndWall_m + 0.04f}}};
}

}  // namespace foci
