// Thin wires and slats before a wall. One pixel, splat or layer there shows two surfaces.
#include <array>
#include <cmath>

#include "render/scene/builtin/pattern.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

constexpr float kFence_m = 0.5f, kBehind_m = 1.5f;  // from the eye
constexpr float kWallSide_m = 1.2f;
constexpr int kWallSamples = 400;  // a side
constexpr float kStep_m = 5e-4f;   // between surfels of the fence
constexpr float kRing_m = 0.012f;

using TwoColors = std::array<glm::vec3, 2>;

/// A flat strip across the axis, ringed in two colours.
void addStrip(SurfelCloud& cloud, const glm::vec2& from_m, const glm::vec2& to_m, float width_m,
              const TwoColors& colors) {
  const float length_m = glm::distance(from_m, to_m);
  const glm::vec2 along = (to_m - from_m) / length_m, across(-along.y, along.x);
  const auto columns = static_cast<int>(std::ceil(width_m / kStep_m));
  const auto rows = static_cast<int>(std::ceil(length_m / kStep_m));
  const glm::vec2 step_m = glm::vec2(width_m, length_m) / glm::vec2(columns, rows);
  const float area_m2 = step_m.x * step_m.y;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const glm::vec2 at_m = (glm::vec2(column, row) + 0.5f) * step_m;
      const glm::vec2 p_m = from_m + across * (at_m.x - 0.5f * width_m) + along * at_m.y;
      appendSurfel(cloud, {p_m, -kFence_m}, {0.0f, 0.0f, 1.0f},
                   kSigmaPerSpacing * std::sqrt(area_m2), area_m2,
                   colors[static_cast<std::size_t>(at_m.y / kRing_m) % colors.size()]);
    }
  }
}

}  // namespace

SurfelCloud makeFence() {
  SurfelCloud cloud = makePlane(kWallSamples, kWallSide_m);
  const auto upright = [](const glm::vec3& p) { return glm::vec3(p.x, -p.z, p.y); };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.position_m[i] = upright(cloud.position_m[i]) - glm::vec3(0.0f, 0.0f, kBehind_m);
    cloud.axis_u_m[i] = upright(cloud.axis_u_m[i]);
    cloud.axis_v_m[i] = upright(cloud.axis_v_m[i]);
  }
  const TwoColors red{srgb(0xc9382b), srgb(0xf1d7a8)}, blue{srgb(0x1f2f4a), srgb(0x5f86c2)};
  constexpr std::array<float, 4> kWidths_m{0.0005f, 0.001f, 0.002f, 0.004f};
  for (int i = 0; i < 12; ++i) {
    const float x_m = 0.022f * (static_cast<float>(i) - 5.5f);
    const float lean_m = 0.012f * static_cast<float>(i % 3 - 1);
    addStrip(cloud, {x_m - lean_m, -0.2f}, {x_m + lean_m, 0.2f}, kWidths_m[i % kWidths_m.size()],
             i % 2 == 0 ? red : blue);
  }
  addStrip(cloud, {-0.2f, -0.06f}, {0.2f, 0.05f}, 0.003f, blue);
  return cloud;
}

EyePose fenceEyePose() { return {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -kBehind_m}}; }

}  // namespace foci
