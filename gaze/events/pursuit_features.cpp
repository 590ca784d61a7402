#include "gaze/events/pursuit_features.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {
namespace {

constexpr double kStill_deg_s = 3.0;  // slower motion has hardly a direction

/// Agreement, speed and distance of a neighbour, and the saccade between the two.
void addNeighbour(const DriftLine& whole, const DriftLine* other, double noise_deg, bool is_before,
                  float*& out) {
  if (!other || other->count() < 3.0) {
    for (int i = 0; i < 6; ++i) *out++ = -5.0F;
    return;
  }
  const glm::dvec3 u = whole.velocity_deg_s();
  const glm::dvec3 jump =
      glm::degrees(is_before ? whole.first() - other->newest() : other->first() - whole.newest());
  const double jump_deg = glm::length(jump), speed_deg_s = glm::length(u);
  *out++ = static_cast<float>(whole.agreement(*other, noise_deg, kStill_deg_s));
  *out++ = static_cast<float>(std::log(glm::length(other->velocity_deg_s()) + 0.3));
  *out++ = static_cast<float>(std::log(other->distance_deg(noise_deg) + 0.1));
  *out++ = static_cast<float>(other->straightness());
  *out++ = static_cast<float>(std::log(jump_deg + 0.1));
  *out++ = static_cast<float>(glm::dot(jump, u) / (jump_deg * speed_deg_s + 0.5 * kStill_deg_s));
}

}  // namespace

PursuitFeatureVector pursuitFeatures(const StableContext& context) {
  PursuitFeatureVector features{};
  float* out = features.data();
  const auto add = [&](double value) { *out++ = static_cast<float>(value); };
  const DriftLine& whole = *context.whole;
  const double noise_deg = context.noise_deg;
  const double speed_deg_s = glm::length(whole.velocity_deg_s());
  add(std::log(whole.duration_s() + 0.01));
  add(std::log(whole.distance_deg(noise_deg) + 0.1));
  add(std::log(std::sqrt(std::max(whole.variance_deg2() - 2.0 * noise_deg * noise_deg, 0.0)) +
               0.05));
  add(std::log(speed_deg_s + 0.3));
  add(std::log(speed_deg_s / whole.velocityError_deg_s(noise_deg) + 0.1));
  add(whole.straightness());

  for (const double window_s : {0.1, 0.2, kPursuitWindow_s}) {
    constexpr double kSlack_s = 1e-5;
    const double until_s = context.time_s + (context.centred ? 0.5 * window_s : 0.0);
    const double from_s = until_s - window_s;
    DriftLine line;
    for (const TimedSight& sight : context.near) {
      if (sight.time_s > until_s + kSlack_s) break;
      if (sight.direction && sight.time_s >= from_s - kSlack_s) {
        line.add(sight.time_s, *sight.direction);
      }
    }
    const double local_deg_s = glm::length(line.velocity_deg_s());
    add(std::log(local_deg_s + 0.3));
    add(std::log(local_deg_s / line.velocityError_deg_s(noise_deg) + 0.1));
    add(line.agreement(whole, noise_deg, kStill_deg_s));
    add(line.straightness());
  }
  addNeighbour(whole, context.before, noise_deg, true, out);
  addNeighbour(whole, context.after, noise_deg, false, out);
  if (context.before_that && context.before_that->count() >= 3.0) {
    add(whole.agreement(*context.before_that, noise_deg, kStill_deg_s));
  } else {
    add(-5.0);
  }
  add(std::log(context.time_s - whole.first_s() + 0.01));
  add(std::log(std::max(whole.newest_s() - context.time_s, 0.0) + 0.01));
  assert(out == features.data() + kPursuitFeatures);
  return features;
}

}  // namespace foci
