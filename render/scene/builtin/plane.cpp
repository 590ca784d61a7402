// The paper's textured plane (Table 1, Figure 6). The texture is our own. It has coarse and fine
// detail side by side, so that any blur is visible.
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "render/scene/builtin/pattern.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

/// @param p  0 to 1 over the plane
glm::vec3 planeTexture(glm::vec2 p) {
  const glm::vec2 tile = p * 16.0f, inside = tile - glm::floor(tile);
  const auto x = static_cast<int>(tile.x), y = static_cast<int>(tile.y);
  const bool dark = checker(tile) > 0.5f;
  glm::vec3 color = dark ? srgb(0x27455c) : srgb(0xe9dcc3);
  const glm::vec3 ink = dark ? srgb(0xd9b36a) : srgb(0x8c2f2b);
  const glm::vec2 d = inside - 0.5f;
  const float radius = glm::length(d);
  float mark = 0.0f;
  switch (static_cast<int>(hash01(x, y, 7) * 4.0f)) {
    case 0:
      mark = checker(inside * 8.0f) * (radius < 0.4f ? 1.0f : 0.0f);
      break;
    case 1:
      mark = std::fmod(std::floor(radius * 20.0f), 2.0f) * (radius < 0.42f ? 1.0f : 0.0f);
      break;
    case 2:  // Siemens star
      mark = radius < 0.42f && std::sin(std::atan2(double{d.y}, double{d.x}) * 12.0) > 0.0 ? 1.0f
                                                                                           : 0.0f;
      break;
    default:
      mark = lines(inside.x * 6.0f + inside.y * 3.0f, 0.18f) * (radius < 0.45f ? 1.0f : 0.0f);
  }
  color = glm::mix(color, ink, mark);
  return color * (0.85f + 0.3f * fractalNoise(p * 120.0f, 3, 3));
}

}  // namespace

SurfelCloud makePlane(int samples, float side_m) {
  assert(samples > 0);
  SurfelCloud cloud;
  const auto side = static_cast<std::size_t>(samples);
  const float step_m = side_m / static_cast<float>(samples);
  const float sigma_m = kSigmaPerSpacing * step_m;
  cloud.position_m.resize(side * side);
  cloud.color.resize(side * side);
  cloud.axis_u_m.assign(side * side, glm::vec3(0.0f, 0.0f, sigma_m));
  cloud.axis_v_m.assign(side * side, glm::vec3(sigma_m, 0.0f, 0.0f));
  cloud.area_m2.assign(side * side, step_m * step_m);
  parallelFor(side * side, [&](std::size_t i) {
    const glm::vec2 p =
        (glm::vec2(static_cast<float>(i % side), static_cast<float>(i / side)) + 0.5f) /
        static_cast<float>(samples);
    cloud.position_m[i] = {side_m * (p.x - 0.5f), 0.0f, side_m * (p.y - 0.5f)};
    cloud.color[i] = planeTexture(p);
  });
  return cloud;
}

EyePose planeEyePose() { return {{0.0f, 0.9f, 1.35f}, {0.0f, 0.0f, 0.05f}}; }

}  // namespace foci
