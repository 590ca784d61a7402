#include "tests/faces/observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foci::faces {
namespace {

constexpr double kSaccade_s = 0.04;
constexpr double kBlink_s = 0.25;

double ease(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Slow motion without a visible period, -1 to 1.
double sway(double time_s, std::uint32_t which, std::uint32_t seed) {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double rate_Hz = 0.07 + 0.25 * static_cast<double>(noiseAt(which, k, seed));
    const double phase = 6.3 * static_cast<double>(noiseAt(which, k + 10, seed));
    sum += std::sin(2.0 * std::numbers::pi * rate_Hz * time_s + phase) / 3.0;
  }
  return sum;
}

}  // namespace

glm::dvec3 onScreen_m(const Sitting& sitting, const glm::dvec2& point_m) {
  return {-point_m.x, sitting.camera_above_m - point_m.y, 0.0};
}

Observer::Observer(const Sitting& sitting, std::vector<ShownTarget> targets)
    : sitting_(sitting), targets_(std::move(targets)) {}

double Observer::closedAt(double time_s) const {
  if (!(sitting_.blink_every_s > 0.0)) return 0.0;
  // Each interval has one blink, at a random time.
  const double interval = std::floor(time_s / sitting_.blink_every_s);
  const double share =
      static_cast<double>(noiseAt(static_cast<std::uint32_t>(interval + 8.0), 3, sitting_.seed));
  const double middle = (interval + 0.2 + 0.6 * share) * sitting_.blink_every_s;
  const double off = std::abs(time_s - middle) / (0.5 * kBlink_s);
  return ease(2.0 * (1.0 - off));
}

Moment Observer::at(double time_s) const {
  Moment moment;
  glm::dvec2 point = targets_.front().point_m;
  for (std::size_t i = 1; i < targets_.size(); ++i) {
    const double t = (time_s - targets_[i].from_s - sitting_.latency_s) / kSaccade_s;
    if (t > 0.0) point = glm::mix(targets_[i - 1].point_m, targets_[i].point_m, ease(t));
  }
  moment.looks_at_m = onScreen_m(sitting_, point);
  const auto swayed = [&](std::uint32_t which) { return sway(time_s, which, sitting_.seed); };
  moment.head_m = sitting_.head_m + sitting_.sway_m * glm::dvec3(swayed(0), swayed(1), swayed(2));
  // The head turns a quarter of the way towards the target, after the eyes.
  glm::dvec2 towards = targets_.front().point_m;
  for (std::size_t i = 1; i < targets_.size(); ++i) {
    const double t = (time_s - targets_[i].from_s - sitting_.latency_s) / 0.6;
    if (t > 0.0) towards = glm::mix(targets_[i - 1].point_m, targets_[i].point_m, ease(t));
  }
  const glm::dvec3 to = onScreen_m(sitting_, towards) - sitting_.head_m;
  constexpr double kHeadShare = 0.25;
  moment.yaw_rad = kHeadShare * std::atan2(-to.x, -to.z) + sitting_.sway_rad * swayed(3);
  moment.pitch_rad = kHeadShare * std::atan2(-to.y, -to.z) + sitting_.sway_rad * swayed(4);
  moment.roll_rad = sitting_.sway_rad * swayed(5);
  moment.closed = closedAt(time_s);
  return moment;
}

}  // namespace foci::faces
