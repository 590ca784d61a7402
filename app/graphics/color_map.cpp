#include "app/graphics/color_map.h"

#include <algorithm>
#include <cstdint>

#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kStops = 10;
constexpr std::array<std::array<std::uint32_t, kStops>, 4> kCodes{{
    {0x000004, 0x1b0c41, 0x4a0c6b, 0x781c6d, 0xa52c60, 0xcf4446, 0xed6925, 0xfb9b06, 0xf7d13d,
     0xfcffa4},
    {0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b,
     0xfde725},
    {0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55,
     0xfee838},
    {0x000000, 0x1c1c1c, 0x393939, 0x555555, 0x717171, 0x8e8e8e, 0xaaaaaa, 0xc6c6c6, 0xe3e3e3,
     0xffffff},
}};
constexpr float kLeastHeat = 0.25f;  // place on the map where heat begins

float onMap(float share) { return kLeastHeat + (1.0f - kLeastHeat) * share; }

}  // namespace

glm::vec3 colorAt(ColorMap map, float share) {
  const float at = static_cast<float>(kStops - 1) * std::clamp(share, 0.0f, 1.0f);
  const auto low = std::min(static_cast<std::size_t>(at), kStops - 2);
  const auto code = [&](std::size_t stop) {
    const std::uint32_t rgb = kCodes.at(static_cast<std::size_t>(map)).at(stop);
    return glm::vec3(rgb >> 16U, (rgb >> 8U) & 255U, rgb & 255U) / 255.0f;
  };
  return glm::mix(code(low), code(low + 1), at - static_cast<float>(low));
}

std::string hexOf(const glm::vec3& code) {
  const glm::uvec3 byte(glm::round(255.0f * glm::clamp(code, 0.0f, 1.0f)));
  return printed("#%02x%02x%02x", byte.r, byte.g, byte.b);
}

glm::vec3 heatAt(ColorMap map, float share, float grey) {
  if (!(share > 0.0f)) return glm::vec3(grey);
  return glm::mix(glm::vec3(grey), colorAt(map, onMap(share)), std::min(8.0f * share, 1.0f));
}

}  // namespace foci
