#include "render/scene/builtin/pattern.h"

#include <array>
#include <cmath>

namespace foci {

float hash01(std::int32_t x, std::int32_t y, std::int32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                    static_cast<std::uint32_t>(y) * 0xd8163841u ^
                    static_cast<std::uint32_t>(seed) * 0xcb1ab31fu;
  h = (h ^ h >> 16) * 0x85ebca6bu;
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  return static_cast<float>((h ^ h >> 16) >> 8) * 0x1p-24f;
}

float noise(glm::vec2 p, std::int32_t seed) {
  const glm::vec2 cell = glm::floor(p), f = p - cell;
  const glm::vec2 w = f * f * (3.0f - 2.0f * f);
  const auto x = static_cast<std::int32_t>(cell.x), y = static_cast<std::int32_t>(cell.y);
  return glm::mix(glm::mix(hash01(x, y, seed), hash01(x + 1, y, seed), w.x),
                  glm::mix(hash01(x, y + 1, seed), hash01(x + 1, y + 1, seed), w.x), w.y);
}

float fractalNoise(glm::vec2 p, int octaves, std::int32_t seed) {
  float sum = 0.0f, strength = 0.5f, total = 0.0f;
  for (int i = 0; i < octaves; ++i, strength *= 0.5f) {
    sum += strength * noise(p, seed + i);
    total += strength;
    p = glm::vec2(1.6f * p.x - 1.2f * p.y, 1.2f * p.x + 1.6f * p.y);
  }
  return sum / total;
}

float checker(glm::vec2 p) {
  const glm::vec2 cell = glm::floor(p);
  return std::fmod(std::abs(cell.x + cell.y), 2.0f);
}

float lines(float x, float half_width) {
  const float distance = std::abs(x - std::round(x));
  return 1.0f - glm::smoothstep(half_width, 2.0f * half_width, distance);
}

glm::vec3 cells(glm::vec2 p, std::int32_t seed) {
  const glm::vec2 cell = glm::floor(p);
  glm::vec3 found(9.0f, 9.0f, 0.0f);
  for (int i = 0; i < 9; ++i) {
    const glm::vec2 c =
        cell + glm::vec2(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 - 1));
    const auto x = static_cast<std::int32_t>(c.x), y = static_cast<std::int32_t>(c.y);
    const glm::vec2 point = c + glm::vec2(hash01(x, y, seed), hash01(x, y, seed + 1));
    const float distance = glm::length(point - p);
    if (distance < found.x) {
      found = glm::vec3(distance, found.x, hash01(x, y, seed + 2));
    } else if (distance < found.y) {
      found.y = distance;
    }
  }
  return found;
}

glm::vec3 srgb(std::uint32_t rgb) {
  static const std::array<float, 256> kLinear = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const float s = static_cast<float>(i) / 255.0f;
      table[i] = s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
    }
    return table;
  }();
  return {kLinear[rgb >> 16 & 0xffu], kLinear[rgb >> 8 & 0xffu], kLinear[rgb & 0xffu]};
}

}  // namespace foci
