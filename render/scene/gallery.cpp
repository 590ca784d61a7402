// The gallery: what stands where, and how it is painted. Lamps and shadows are in gallery_light.
#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "render/scene/gallery_light.h"
#include "render/scene/gallery_shapes.h"
#include "render/scene/pattern.h"
#include "render/scene/procedural.h"
#include "render/scene/sample_surface.h"

namespace foci {
namespace {

constexpr float kTable_m = 1.22f;
constexpr float kWall_m = 1.55f;  // half the room's width
constexpr float kEnd_m = -6.0f;
constexpr float kCeiling_m = 3.6f;
constexpr float kFocal_px = 1536.0f;  // of a 0.5 m wide screen of 1280 px, 0.6 m away
constexpr float kStep_px = 1.7f;
const glm::vec2 kHalfView{0.417f, 0.234f};

const glm::vec3 kEye{0.0f, 1.45f, 0.0f};
const glm::vec3 kLookAt{0.0f, 1.31f, -2.0f};
const glm::vec3 kKnot{-0.185f, kTable_m + 0.175f, -1.12f};
const glm::vec3 kBall{0.015f, kTable_m + 0.042f, -0.86f};
const glm::vec3 kMask{0.105f, 1.475f, -1.36f};
const glm::vec3 kBust{0.25f, 1.545f, -1.95f};
const glm::vec3 kVase{-0.80f, 1.02f, -3.2f};
const glm::vec3 kSpheres{0.95f, 1.0f, -4.3f};

using Paint = std::function<glm::vec3(const SurfacePoint&)>;

/// The scene as it is put together.
class Gallery {
 public:
  Gallery() : light_(kEye) {}

  void addOccluder(const glm::vec3& center, float radius) { light_.addOccluder(center, radius); }

  void add(Shape shape, Paint paint, const Material& material, float opacity = 1.0f,
           std::function<bool(const SurfacePoint&)> keep = {}) {
    const glm::vec3 forward = glm::normalize(kLookAt - kEye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0.0f, 1.0f, 0.0f)));
    const SampledFor audience{.eye_m = kEye,
                              .right = right,
                              .up = glm::cross(right, forward),
                              .forward = forward,
                              .half_view = kHalfView,
                              .step_rad = material.coarse * kStep_px / kFocal_px};
    const ParametricSurface surface{
        .at = std::move(shape),
        .paint = std::move(paint),
        .light = [this, material](
                     const SurfacePoint& at,
                     const glm::vec3& colour) { return light_.shade(at, colour, material); },
        .keep = std::move(keep),
        .opacity = opacity,
        .two_sided = material.two_sided};
    appendSurface(cloud_, surface, audience);
  }

  SurfelCloud take() {
    cloud_.oriented = true;
    return std::move(cloud_);
  }

 private:
  GalleryLight light_;
  SurfelCloud cloud_;
};

glm::vec3 marble(const glm::vec3& p, const glm::vec3& base, const glm::vec3& vein, float scale) {
  const glm::vec2 q = scale * glm::vec2(p.x + 0.6f * p.y, p.z - 0.5f * p.y);
  const float warp = fractalNoise(q * 3.0f + 100.0f, 5, 31);
  const float line = std::abs(std::sin(6.0f * q.x + 2.0f * q.y + 9.0f * warp));
  const float thin = std::pow(1.0f - line, 6.0f);
  const float grain = fractalNoise(q * 90.0f + 50.0f, 2, 37);
  return glm::mix(base, vein, 0.75f * thin + 0.25f * warp * warp) * (0.88f + 0.24f * grain);
}

glm::vec3 wood(glm::vec2 p, std::int32_t seed) {
  const float ring = fractalNoise({p.x * 3.0f, p.y * 60.0f}, 3, seed);
  const float pore = fractalNoise({p.x * 40.0f, p.y * 700.0f}, 2, seed + 5);
  return glm::mix(srgb(0x5b3319), srgb(0xa86f3c), 0.7f * ring + 0.3f * pore);
}

void addRoom(Gallery& gallery) {
  const Material matt{.coarse = 1.3f};
  // Floor: parquet in herring-bone blocks.
  gallery.add(rectangle({-kWall_m, 0.0f, -2.6f}, {2.0f * kWall_m, 0, 0}, {0, 0, kEnd_m + 2.6f}),
              [](const SurfacePoint& at) {
                const glm::vec2 p = glm::vec2(at.p_world.x, at.p_world.z) / 0.18f;
                const glm::vec2 cell = glm::floor(p);
                const bool turned = checker(p) > 0.5f;
                const glm::vec2 inside = turned ? glm::vec2(p.y - cell.y, p.x - cell.x) : p - cell;
                const float plank = std::floor(inside.y * 4.0f);
                const auto seed = static_cast<std::int32_t>(plank);
                const float shade =
                    hash01(static_cast<int>(cell.x), static_cast<int>(cell.y), seed);
                const float gap = lines(inside.y * 4.0f, 0.03f) + lines(inside.x, 0.01f);
                return wood(inside + cell * 3.7f + plank, 41) * (0.55f + 0.55f * shade) *
                       (1.0f - 0.7f * std::min(gap, 1.0f));
              },
              {.gloss = 0.12f, .hardness = 60.0f, .coarse = 6.0f});
  // Walls: damask over a panelled dado.
  const auto wall = [](float along, float y) {
    if (y < 0.95f) {
      const float panel = std::abs(along / 0.6f - std::round(along / 0.6f));
      const float bead = lines(panel * 2.4f, 0.02f) + lines((y - 0.12f) / 0.72f, 0.015f);
      return wood({y * 0.7f, along}, 47) * (0.9f - 0.45f * std::min(bead, 1.0f));
    }
    if (y < 1.0f) return srgb(0xc9a45a) * (0.7f + 0.5f * std::sin((y - 0.95f) * 62.0f));
    const glm::vec2 p(along / 0.24f, y / 0.32f);
    const glm::vec2 q = p - glm::floor(p) - 0.5f;
    const float shift = std::fmod(std::abs(std::floor(p.y)), 2.0f) * 0.5f;
    const float x = (p.x + shift) - std::floor(p.x + shift) - 0.5f;
    const float petal = std::abs(x) - 0.33f * std::cos(q.y * glm::pi<float>()) *
                                          (0.75f + 0.25f * std::cos(q.y * 18.0f));
    const float ornament = 1.0f - glm::smoothstep(-0.02f, 0.02f, petal);
    const float core =
        1.0f - glm::smoothstep(0.0f, 0.03f, std::abs(std::abs(petal) - 0.09f) - 0.018f);
    const glm::vec3 ground = srgb(0x24463f), figure = srgb(0x3d6a5b), gold = srgb(0x9c8a4e);
    const float weave = 0.85f + 0.3f * noise({along * 260.0f, y * 260.0f}, 53);
    return glm::mix(glm::mix(ground, figure, ornament), gold, 0.6f * core) * weave;
  };
  gallery.add(
      rectangle({-kWall_m, 0.0f, kEnd_m}, {2.0f * kWall_m, 0, 0}, {0, kCeiling_m, 0}),
      [=](const SurfacePoint& at) { return wall(at.p_world.x, at.p_world.y); }, matt);
  gallery.add(
      rectangle({-kWall_m, 0.0f, kEnd_m}, {0, kCeiling_m, 0}, {0, 0, 3.6f}),
      [=](const SurfacePoint& at) { return wall(at.p_world.z, at.p_world.y); }, matt);
  gallery.add(
      rectangle({kWall_m, 0.0f, -2.4f}, {0, kCeiling_m, 0}, {0, 0, kEnd_m + 2.4f}),
      [=](const SurfacePoint& at) { return wall(at.p_world.z, at.p_world.y); }, matt);
}

/// A landscape at dusk. @param p  0 to 1, y up
glm::vec3 landscape(glm::vec2 p) {
  const float horizon = 0.42f;
  const glm::vec2 sun(0.64f, 0.50f);
  glm::vec3 sky = glm::mix(srgb(0xf3b562), srgb(0x35507f), glm::smoothstep(horizon, 1.0f, p.y));
  const float cloud = fractalNoise({p.x * 5.0f, p.y * 16.0f}, 5, 61);
  sky = glm::mix(sky, srgb(0xe8775a), 0.8f * glm::smoothstep(0.5f, 0.75f, cloud));
  const glm::vec2 off = (p - sun) * glm::vec2(1.6f, 1.0f);
  sky = glm::mix(sky, srgb(0xfff3c9), std::exp(-glm::dot(off, off) * 120.0f));
  glm::vec3 color = sky;
  for (int ridge = 0; ridge < 4; ++ridge) {
    const auto k = static_cast<float>(ridge);
    const float height =
        horizon + 0.13f - 0.10f * k +
        0.16f * (fractalNoise({p.x * (3.0f + 2.0f * k) + 9.0f * k, k}, 5, 67 + ridge) - 0.5f);
    if (p.y < height) {
      const float tree = fractalNoise(p * (60.0f + 30.0f * k), 3, 71 + ridge);
      color = glm::mix(srgb(0x6f6d92), srgb(0x1e3524), k / 3.0f) * (0.7f + 0.6f * tree);
    }
  }
  return color * (0.85f + 0.3f * fractalNoise({p.x * 300.0f, p.y * 120.0f}, 2, 73));
}

/// Coloured panes in black leads.
glm::vec3 panes(glm::vec2 p) {
  const glm::vec3 cell = cells(p * 9.0f, 79);
  static const std::array<glm::vec3, 5> kColours{srgb(0xd1495b), srgb(0xedae49), srgb(0x66a182),
                                                 srgb(0x2e6f95), srgb(0xf2e8cf)};
  const glm::vec3 pane = kColours[static_cast<std::size_t>(cell.z * 4.999f)];
  const float lead = 1.0f - glm::smoothstep(0.02f, 0.07f, cell.y - cell.x);
  return glm::mix(pane * (0.75f + 0.5f * fractalNoise(p * 70.0f, 3, 83)), glm::vec3(0.01f), lead);
}

/// Rings of moiré, an Op Art print.
glm::vec3 rings(glm::vec2 p) {
  const float a = std::sin(glm::length(p - glm::vec2(0.35f, 0.4f)) * 90.0f);
  const float b = std::sin(glm::length(p - glm::vec2(0.68f, 0.65f)) * 90.0f);
  return a * b > 0.0f ? srgb(0xf5efe0) : srgb(0x23395b);
}

/// A picture in a gilt frame. `right` and `up` span the whole, frame included; the wall is behind.
void addPicture(Gallery& gallery, const glm::vec3& corner, const glm::vec3& right,
                const glm::vec3& up, glm::vec3 (*picture)(glm::vec2)) {
  const float width = glm::length(right), height = glm::length(up), bar = 0.09f;
  gallery.add(rectangle(corner, right, up),
              [=](const SurfacePoint& at) {
                const glm::vec2 p(at.uv.x * width, at.uv.y * height);
                const glm::vec2 edge = glm::min(p, glm::vec2(width, height) - p);
                const float depth = std::min(edge.x, edge.y);
                if (depth > bar) {
                  return picture((p - bar) / (glm::vec2(width, height) - 2.0f * bar));
                }
                const float along = edge.x < edge.y ? p.y : p.x;
                const float moulding = 0.6f + 0.4f * std::sin(depth / bar * 11.0f + 0.6f);
                const float carving = 0.8f + 0.2f * std::sin(along * 160.0f) *
                                                 std::sin(depth / bar * glm::pi<float>());
                return srgb(0xd8aa4f) * moulding * carving;
              },
              {.gloss = 0.05f});
}

void addTable(Gallery& gallery) {
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
  gallery.add(rectangle(corner, {0.92f, 0, 0}, {0, 0, -1.75f}), stone,
              {.gloss = 0.10f, .hardness = 90.0f});
}

/// Things from 0.25 to 0.5 m: a plant on the left, brass lattice on the right.
void addForeground(Gallery& gallery) {
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
    gallery.add(
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
      gallery.add(leaf(curve(t), length * out, 0.30f * length * side, 0.4f * length),
                  green(stem * 7 + i), waxy);
    }
  }

  const Paint brass = [](const SurfacePoint& at) {
    const float twist = std::sin(glm::two_pi<float>() * (at.uv.x + at.uv.y * 38.0f));
    return srgb(0xd6a648) * (0.75f + 0.25f * twist);
  };
  const Material metal{.gloss = 0.5f, .hardness = 30.0f, .shadowed = false};
  const auto wire = [&](const glm::vec3& a, const glm::vec3& b, float radius) {
    gallery.add(
        tube([=](float t) { return glm::mix(a, b, t); }, [=](float) { return radius; }, {0, 0, 1}),
        brass, metal);
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

void addTableExhibits(Gallery& gallery) {
  gallery.addOccluder(kBall, 0.042f);
  gallery.add(
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
    gallery.addOccluder(center, radius);
    gallery.add(ball(center, radius),
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
  for (int i = 0; i < 20; ++i) gallery.addOccluder(knot(static_cast<float>(i) / 20.0f), 0.019f);
  gallery.add(tube(knot, [](float) { return 0.021f; }, {0, 0, 1}),
              [](const SurfacePoint& at) {
                const float spiral = at.uv.x * 3.0f + at.uv.y * 42.0f;
                const float band = glm::smoothstep(
                    0.40f, 0.46f, std::abs(spiral - std::floor(spiral) - 0.5f) * 2.0f);
                const float fine = lines(at.uv.y * 336.0f, 0.12f);
                const glm::vec3 blue = glm::mix(srgb(0x1d4e89), srgb(0x8fc1e3), 0.5f * fine);
                return glm::mix(blue, srgb(0xf4a259), band) *
                       (0.85f + 0.3f * fractalNoise({at.uv.x * 24.0f, at.uv.y * 500.0f}, 2, 101));
              },
              {.gloss = 0.4f, .hardness = 70.0f});
  const glm::vec3 plinth(kKnot.x, kTable_m, kKnot.z);
  gallery.addOccluder(plinth + glm::vec3(0, 0.02f, 0), 0.05f);
  gallery.add(lathe(plinth, {{0.070f, 0.0f},
                             {0.070f, 0.012f},
                             {0.058f, 0.020f},
                             {0.048f, 0.045f},
                             {0.052f, 0.060f},
                             {0.0f, 0.061f}}),
              [](const SurfacePoint& at) {
                return marble(at.p_world, srgb(0x2c2b2e), srgb(0xd8c9a8), 9.0f);
              },
              {.gloss = 0.25f, .hardness = 80.0f});
}

/// A bust, and the half-transparent mask before it.
void addFigure(Gallery& gallery) {
  const float scale = 1.35f;
  const Paint stone = [](const SurfacePoint& at) {
    return marble(at.p_world, srgb(0xede4d3), srgb(0x9a8468), 6.0f);
  };
  const Material polished{.gloss = 0.10f, .hardness = 35.0f};
  gallery.addOccluder(kBust, 0.115f);
  gallery.addOccluder(kBust + glm::vec3(0, -0.27f, 0), 0.13f);
  gallery.add(head(kBust, scale, {-glm::pi<float>(), glm::pi<float>()}, {-1.45f, 1.5707f}, true),
              stone, polished);
  const Shape trunk = lathe({0, 0, 0}, {{0.075f, 0.0f},
                                        {0.078f, 0.012f},
                                        {0.05f, 0.024f},
                                        {0.042f, 0.045f},
                                        {0.075f, 0.075f},
                                        {0.118f, 0.115f},
                                        {0.142f, 0.155f},
                                        {0.138f, 0.18f},
                                        {0.098f, 0.203f},
                                        {0.066f, 0.225f},
                                        {0.060f, 0.29f}});
  gallery.add(
      [trunk](glm::vec2 uv) {
        const glm::vec3 p = trunk(uv);
        const float wide =
            1.0f + 0.2f * glm::smoothstep(0.05f, 0.12f, p.y) * glm::smoothstep(0.21f, 0.17f, p.y);
        return glm::vec3(kBust.x, kTable_m, kBust.z) + glm::vec3(p.x * wide, p.y, p.z * 0.8f);
      },
      stone, polished);

  const glm::vec2 azimuth{-1.15f, 1.15f}, elevation{-0.78f, 0.72f};
  gallery.add(
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
  for (const float x : {-0.072f, 0.072f}) {
    const glm::vec3 low = kMask + glm::vec3(x, 0.055f, 0.045f),
                    high(kMask.x + 0.4f * x, 1.95f, kMask.z);
    gallery.add(tube([=](float t) { return glm::mix(low, high, t); }, [](float) { return 0.0008f; },
                     {0, 0, 1}),
                [](const SurfacePoint&) { return srgb(0xe8dcc0); }, {.shadowed = false});
  }
}

/// On pedestals behind the table: a fluted vase, a pile of spheres.
void addPedestals(Gallery& gallery) {
  const Paint plaster = [](const SurfacePoint& at) {
    return srgb(0xcfc6b8) *
           (0.8f + 0.3f * fractalNoise({at.uv.x * 60.0f, at.p_world.y * 60.0f}, 4, 107));
  };
  for (const glm::vec3& top : {kVase, kSpheres}) {
    gallery.addOccluder(top - glm::vec3(0, 0.2f, 0), 0.2f);
    gallery.add(lathe({top.x, 0.0f, top.z},
                      {{0.26f, 0.35f},
                       {0.20f, 0.45f},
                       {0.19f, top.y - 0.12f},
                       {0.21f, top.y - 0.08f},
                       {0.25f, top.y - 0.04f},
                       {0.25f, top.y},
                       {0.0f, top.y}},
                      16, 0.08f),
                plaster, {.gloss = 0.02f, .coarse = 2.0f});
  }
  gallery.addOccluder(kVase + glm::vec3(0, 0.24f, 0), 0.16f);
  gallery.addOccluder(kVase + glm::vec3(0, 0.45f, 0), 0.07f);
  gallery.add(
      lathe(kVase, {{0.085f, 0.0f},
                    {0.09f, 0.02f},
                    {0.06f, 0.05f},
                    {0.12f, 0.15f},
                    {0.175f, 0.27f},
                    {0.15f, 0.38f},
                    {0.065f, 0.46f},
                    {0.06f, 0.52f},
                    {0.10f, 0.56f}}),
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
    gallery.addOccluder(center, pile[i].w);
    gallery.add(ball(center, pile[i].w),
                [tint = tints[i], i](const SurfacePoint& at) {
                  const float stripe =
                      lines(at.uv.y * 14.0f + (i % 2 == 0 ? 0.0f : at.uv.x * 8.0f), 0.12f);
                  return glm::mix(tint, srgb(0x1d1d24), 0.75f * stripe) *
                         (0.85f + 0.3f * fractalNoise({at.uv.x * 80.0f, at.uv.y * 40.0f}, 3, 113));
                },
                {.gloss = 0.35f, .hardness = 80.0f});
  }
}

}  // namespace

SurfelCloud makeGallery() {
  Gallery gallery;
  addForeground(gallery);
  addTableExhibits(gallery);
  addFigure(gallery);
  addPedestals(gallery);
  addTable(gallery);
  addPicture(gallery, {-0.95f, 1.22f, kEnd_m + 0.04f}, {1.25f, 0, 0}, {0, 0.86f, 0}, landscape);
  addPicture(gallery, {0.55f, 1.55f, kEnd_m + 0.04f}, {0.62f, 0, 0}, {0, 0.62f, 0}, rings);
  addPicture(gallery, {-kWall_m + 0.03f, 1.2f, -4.3f}, {0, 0, -1.0f}, {0, 0.8f, 0}, panes);
  addPicture(gallery, {kWall_m - 0.03f, 1.2f, -5.6f}, {0, 0, 1.1f}, {0, 0.75f, 0}, panes);
  addRoom(gallery);
  return gallery.take();
}

EyePose galleryEyePose() { return {kEye, kLookAt}; }

std::vector<PointOfInterest> galleryPointsOfInterest() {
  return {{"leaves", {-0.095f, 1.43f, -0.29f}},
          {"lattice", {0.108f, 1.42f, -0.457f}},
          {"ball", kBall + glm::vec3(0.0f, 0.01f, 0.0408f)},
          {"knot", kKnot + glm::vec3(0.06f, 0.06f, 0.02f)},
          {"mask", kMask + glm::vec3(-0.02f, 0.0f, 0.10f)},
          {"bust", kBust + glm::vec3(0.03f, 0.02f, 0.13f)},
          {"vase", kVase + glm::vec3(0.05f, 0.27f, 0.17f)},
          {"spheres", kSpheres + glm::vec3(0.0f, 0.27f, 0.17f)},
          {"landscape", {-0.25f, 1.63f, kEnd_m + 0.04f}}};
}

}  // namespace foci
