#include "render/image/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/base/parallel.h"

namespace foci {
namespace {

/// A table by linear value is exact enough only if fine: a code value is at least 1 / 3295 wide at
/// the dark end.
constexpr int kSteps = 1 << 16;

std::array<std::uint8_t, kSteps + 1> tabulate() {
  std::array<std::uint8_t, kSteps + 1> table{};
  for (int i = 0; i <= kSteps; ++i) {
    const float srgb = srgbFromLinear(static_cast<float>(i) / kSteps);
    table[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb));
  }
  return table;
}

}  // namespace

float srgbFromLinear(float linear) {
  if (!(linear > 0.0f)) return 0.0f;
  if (linear >= 1.0f) return 1.0f;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linearFromSrgb(float srgb) {
  if (!(srgb > 0.0f)) return 0.0f;
  if (srgb >= 1.0f) return 1.0f;
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

std::vector<std::uint8_t> srgb8(const Frame& frame) {
  static const auto table = tabulate();
  const auto code = [](float linear) {
    const float clamped = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
    return table[static_cast<int>(clamped * kSteps + 0.5f)];
  };
  std::vector<std::uint8_t> rgb(3 * frame.rgba.size());
  const auto width = static_cast<std::size_t>(frame.size_px.x);
  parallelFor(static_cast<std::size_t>(frame.size_px.y), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      for (int c = 0; c < 3; ++c) rgb[3 * i + c] = code(frame.rgba[i][c]);
    }
  });
  return rgb;
}

}  // namespace foci
