#include "render/image/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace foci {
namespace {

/// Entries of the table from linear light to code values. At the dark end a code is only 1 / 3295
/// wide, so a coarser table would miss codes.
constexpr int kSteps = 1 << 16;

std::array<std::uint8_t, kSteps + 1> tabulate() {
  std::array<std::uint8_t, kSteps + 1> table{};
  for (int i = 0; i <= kSteps; ++i) {
    const float srgb = srgbFromLinear(static_cast<float>(i) / kSteps);
    table[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb));
  }
  return table;
}

/// The table's index is the root of the linear value, because a power is steep at the dark end.
std::vector<std::uint8_t> tabulatePower(double gamma) {
  std::vector<std::uint8_t> table(kSteps + 1);
  for (int i = 0; i <= kSteps; ++i) {
    const double code = 255.0 * std::pow(static_cast<double>(i) / kSteps, 2.0 / gamma);
    table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(code));
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

std::vector<std::uint8_t> codesOf(const Frame& frame, std::optional<double> gamma) {
  static const auto srgb = tabulate();
  const auto power = gamma ? tabulatePower(*gamma) : std::vector<std::uint8_t>{};
  const auto powerCode = [&](float linear) {
    const float clamped = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
    return power[static_cast<std::size_t>(std::sqrt(clamped) * kSteps + 0.5f)];
  };
  std::vector<std::uint8_t> rgb(3 * frame.rgba.size());
  const auto width = static_cast<std::size_t>(frame.size_px.x);
  parallelFor(static_cast<std::size_t>(frame.size_px.y), [&](std::size_t y) {
    std::uint8_t* to = rgb.data() + 3 * y * width;
    for (std::size_t i = y * width; i < (y + 1) * width; ++i, to += 3) {
      if (gamma) {
        for (int c = 0; c < 3; ++c) to[c] = powerCode(frame.rgba[i][c]);
        continue;
      }
      // All four channels, so that the compiler can use SIMD.
      const glm::vec4& linear = frame.rgba[i];
      int at[4];
      for (int c = 0; c < 4; ++c) {
        const float clamped = linear[c] > 0.0f ? std::min(linear[c], 1.0f) : 0.0f;
        at[c] = static_cast<int>(clamped * kSteps + 0.5f);
      }
      for (int c = 0; c < 3; ++c) to[c] = srgb[static_cast<std::size_t>(at[c])];
    }
  });
  return rgb;
}

double meanLuminance(const Frame& frame) {
  if (frame.rgba.empty()) return 0.0;
  // Rows are summed in order, so the sum does not depend on the number of threads.
  const auto width = static_cast<std::size_t>(frame.size_px.x);
  std::vector<double> rows(static_cast<std::size_t>(frame.size_px.y));
  parallelFor(rows.size(), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      const glm::vec3 rgb = glm::clamp(glm::vec3(frame.rgba[i]), 0.0f, 1.0f);
      rows[y] += static_cast<double>(glm::dot(rgb, glm::vec3(0.2126f, 0.7152f, 0.0722f)));
    }
  });
  double sum = 0.0;
  for (const double row : rows) sum += row;
  return sum / static_cast<double>(frame.rgba.size());
}

}  // namespace foci
