// What the headset of tests/fake_openxr does, for the runtime and for its tests. Times are seconds
// since the runtime's clock began; poses are in the local frame.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace fake_openxr {

struct Pose {
  glm::dvec3 position_m{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

/// A turn to the right, then upwards, degrees.
inline glm::dquat turned(double right_deg, double up_deg) {
  return glm::angleAxis(-glm::radians(right_deg), glm::dvec3(0.0, 1.0, 0.0)) *
         glm::angleAxis(glm::radians(up_deg), glm::dvec3(1.0, 0.0, 0.0));
}

inline Pose headAt(double time_s) {
  return {.position_m = {0.1 * std::sin(time_s), 0.05 * std::cos(time_s), 0.02 * time_s},
          .rotation = turned(20.0 * std::sin(time_s), 5.0 * std::cos(2.0 * time_s))};
}

/// Both displays are canted outwards by a degree, and no eye stands exactly opposite the other.
inline const std::array<Pose, 2> kEyes{
    Pose{.position_m = {-0.032, 0.001, 0.0}, .rotation = turned(-1.0, 0.0)},
    Pose{.position_m = {0.031, -0.0005, 0.0005}, .rotation = turned(1.0, 0.0)}};

/// Left, right, up, down, degrees.
inline constexpr double kFields_deg[2][4] = {{50.0, 42.0, 45.0, 48.0}, {41.0, 51.0, 44.0, 47.0}};

inline constexpr double kPeriod_s = 0.01, kGaze_Hz = 120.0;
inline constexpr std::int64_t kEpoch_ns = 7'000'000'000'000;  // XrTime of the clock's begin

}  // namespace fake_openxr
