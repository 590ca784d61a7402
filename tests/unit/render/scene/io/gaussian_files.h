// The Gaussians in the files that the tests write, and their bytes.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <string>

namespace foci {

/// The file that each test reads: two Gaussians, the first at (1, -2, 3) with the deviations 0.1,
/// 0.2, 0.4, opacity 0.8, colour (0.75, 0.5, 0.25), turned by 90 degrees about z.
inline const glm::vec3 kPosition(1.0f, -2.0f, 3.0f), kSigma(0.1f, 0.2f, 0.4f),
    kColor(0.75f, 0.5f, 0.25f);
inline constexpr float kOpacity = 0.8f;
inline const float kHalf = std::sqrt(0.5f);
inline const glm::vec4 kRotation(0.0f, 0.0f, kHalf, kHalf);

/// Coefficient `k` of a channel, for files with harmonics.
inline float coefficient(int channel, int k) {
  return 0.03125f * static_cast<float>((k % 5) - 2) + 0.25f * static_cast<float>(channel - 1);
}

template <typename... Values>
void put(std::string& bytes, const Values&... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
}

inline void putByte(std::string& bytes, int value) { bytes.push_back(static_cast<char>(value)); }

}  // namespace foci
