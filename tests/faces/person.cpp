#include "tests/faces/person.h"

#include <array>
#include <cmath>

namespace foci::faces {

float noiseAt(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  h = (h ^ h >> 12) * 0x297A2D39u;
  return static_cast<float>((h ^ h >> 15) >> 8) / 16777216.0f;
}

float smoothNoise(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::uint32_t>(static_cast<std::int32_t>(fx));
  const auto iy = static_cast<std::uint32_t>(static_cast<std::int32_t>(fy));
  const auto ease = [](float t) { return t * t * (3.0f - 2.0f * t); };
  const float u = ease(x - fx), v = ease(y - fy);
  const float upper = glm::mix(noiseAt(ix, iy, seed), noiseAt(ix + 1, iy, seed), u);
  const float lower = glm::mix(noiseAt(ix, iy + 1, seed), noiseAt(ix + 1, iy + 1, seed), u);
  return glm::mix(upper, lower, v);
}

Person somebody(std::uint32_t index) {
  constexpr std::array<glm::vec3, 6> kSkins{{{0.66f, 0.45f, 0.36f},
                                             {0.55f, 0.34f, 0.25f},
                                             {0.45f, 0.27f, 0.18f},
                                             {0.32f, 0.18f, 0.11f},
                                             {0.19f, 0.10f, 0.062f},
                                             {0.105f, 0.055f, 0.036f}}};
  constexpr std::array<glm::vec3, 5> kIrises{{{0.045f, 0.026f, 0.016f},
                                              {0.10f, 0.055f, 0.025f},
                                              {0.10f, 0.085f, 0.04f},
                                              {0.085f, 0.10f, 0.11f},
                                              {0.10f, 0.13f, 0.17f}}};
  const auto draw = [&](std::uint32_t which, double low, double high) {
    return low + (high - low) * static_cast<double>(noiseAt(index, which, 77));
  };
  Person person;
  const std::size_t skin = index % kSkins.size();
  person.skin = kSkins[skin];
  // Light irises go with light skins.
  const std::size_t irises = skin < 3 ? kIrises.size() : 2;
  person.iris = kIrises[(index / kSkins.size() + index) % irises];
  person.hair = glm::mix(glm::vec3(0.012f, 0.010f, 0.009f), glm::vec3(0.16f, 0.10f, 0.055f),
                         skin < 3 ? static_cast<float>(draw(1, 0.0, 1.0)) : 0.0f);
  person.ipd_mm = draw(2, 57.0, 69.0);
  person.nose_mm = draw(3, 17.0, 26.0);
  person.face_width_mm = draw(4, 138.0, 160.0);
  person.pupil_mm = draw(5, 2.5, 5.5);
  person.kappa_deg = {draw(6, 3.0, 6.5), draw(7, -0.5, 2.5)};
  person.beard = draw(8, 0.0, 1.0) > 0.75;
  person.seed = 100 + index;
  return person;
}

}  // namespace foci::faces
