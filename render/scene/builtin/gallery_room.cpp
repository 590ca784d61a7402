#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "render/scene/builtin/gallery_stage.h"
#include "render/scene/builtin/pattern.h"

namespace foci {
namespace {

constexpr float kWall_m = 1.55f;  // half the room's width
constexpr float kCeiling_m = 3.6f;

glm::vec3 wood(glm::vec2 p, std::int32_t seed) {
  const float ring = fractalNoise({p.x * 3.0f, p.y * 60.0f}, 3, seed);
  const float pore = fractalNoise({p.x * 40.0f, p.y * 700.0f}, 2, seed + 5);
  return glm::mix(srgb(0x5b3319), srgb(0xa86f3c), 0.7f * ring + 0.3f * pore);
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

/// A picture in a gilt frame. `right` and `up` span the picture with its frame; the wall is behind.
void addImage(GalleryStage& stage, const glm::vec3& corner, const glm::vec3& right,
              const glm::vec3& up, glm::vec3 (*image)(glm::vec2)) {
  const float width = glm::length(right), height = glm::length(up), bar = 0.09f;
  stage.add(rectangle(corner, right, up),
            [=](const SurfacePoint& at) {
              const glm::vec2 p(at.uv.x * width, at.uv.y * height);
              const glm::vec2 edge = glm::min(p, glm::vec2(width, height) - p);
              const float depth = std::min(edge.x, edge.y);
              if (depth > bar) {
                return image((p - bar) / (glm::vec2(width, height) - 2.0f * bar));
              }
              const float along = edge.x < edge.y ? p.y : p.x;
              const float moulding = 0.6f + 0.4f * std::sin(depth / bar * 11.0f + 0.6f);
              const float carving =
                  0.8f + 0.2f * std::sin(along * 160.0f) * std::sin(depth / bar * glm::pi<float>());
              return srgb(0xd8aa4f) * moulding * carving;
            },
            {.gloss = 0.05f});
}

}  // namespace

void addRoom(GalleryStage& stage) {
  const Material matt{.coarse = 1.3f};
  // Floor: parquet in herring-bone blocks.
  stage.add(rectangle({-kWall_m, 0.0f, -2.6f}, {2.0f * kWall_m, 0, 0}, {0, 0, kEndWall_m + 2.6f}),
            [](const SurfacePoint& at) {
              const glm::vec2 p = glm::vec2(at.p_world.x, at.p_world.z) / 0.18f;
              const glm::vec2 cell = glm::floor(p);
              const bool turned = checker(p) > 0.5f;
              const glm::vec2 inside = turned ? glm::vec2(p.y - cell.y, p.x - cell.x) : p - cell;
              const float plank = std::floor(inside.y * 4.0f);
              const auto seed = static_cast<std::int32_t>(plank);
              const float shade = hash01(static_cast<int>(cell.x), static_cast<int>(cell.y), seed);
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
  stage.add(
      rectangle({-kWall_m, 0.0f, kEndWall_m}, {2.0f * kWall_m, 0, 0}, {0, kCeiling_m, 0}),
      [=](const SurfacePoint& at) { return wall(at.p_world.x, at.p_world.y); }, matt);
  stage.add(
      rectangle({-kWall_m, 0.0f, kEndWall_m}, {0, kCeiling_m, 0}, {0, 0, 3.6f}),
      [=](const SurfacePoint& at) { return wall(at.p_world.z, at.p_world.y); }, matt);
  stage.add(
      rectangle({kWall_m, 0.0f, -2.4f}, {0, kCeiling_m, 0}, {0, 0, kEndWall_m + 2.4f}),
      [=](const SurfacePoint& at) { return wall(at.p_world.z, at.p_world.y); }, matt);

  const float hung = kEndWall_m + 0.04f;
  addImage(stage, {-0.95f, 1.22f, hung}, {1.25f, 0, 0}, {0, 0.86f, 0}, landscape);
  addImage(stage, {0.55f, 1.55f, hung}, {0.62f, 0, 0}, {0, 0.62f, 0}, rings);
  addImage(stage, {-kWall_m + 0.03f, 1.2f, -4.3f}, {0, 0, -1.0f}, {0, 0.8f, 0}, panes);
  addImage(stage, {kWall_m - 0.03f, 1.2f, -5.6f}, {0, 0, 1.1f}, {0, 0.75f, 0}, panes);
}

}  // namespace foci
