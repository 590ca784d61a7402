#include "gaze/events/pursuit.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {

double StableGaze::evidence(double noise_deg, const EventRules& rules) const {
  constexpr double kMinDuration_s = 0.03;  // too short to tell
  if (duration_s() < kMinDuration_s) return -1.0;
  const double noise_deg2 = 2.0 * noise_deg * noise_deg;  // both axes
  // The variance of n samples (two axes) scatters by 1 / sqrt(n) of itself. The noise is known to a
  // seventh, so its square to a factor of 1.3.
  constexpr double kNoiseMargin = 1.3;
  const double margin = kNoiseMargin + 2.0 / std::sqrt(count());
  const double spread_deg = std::sqrt(std::max(variance_deg2() - margin * noise_deg2, 0.0));
  return rules.pursuit_bias + rules.pursuit_duration * std::log(duration_s()) +
         rules.pursuit_distance * std::log(distance_deg(noise_deg) + 0.1) +
         rules.pursuit_spread * std::log(spread_deg + 0.05);
}

bool StableGaze::isPursuit(double noise_deg, const EventRules& rules, const StableGaze* before,
                           const StableGaze* after) const {
  double sum = evidence(noise_deg, rules);
  for (const StableGaze* neighbour : {before, after}) {
    if (!neighbour) continue;
    sum += rules.pursuit_neighbour * agreement(*neighbour, noise_deg, rules.pursuit_still_deg_s);
  }
  return sum > 0.0;
}

void DriftLine::add(double time_s, const glm::dvec3& direction) {
  if (count_ == 0.0) {
    first_s_ = time_s;
    first_ = direction;
  }
  newest_s_ = time_s;
  newest_ = direction;
  count_ += 1.0;
  const double since_s = time_s - first_s_ - mean_s_;
  mean_s_ += since_s / count_;
  squares_s2_ += since_s * (time_s - first_s_ - mean_s_);
  const glm::dvec3 before = direction - mean_;
  mean_ += before / count_;
  products_ += since_s * (direction - mean_);
  squares_ += glm::dot(before, direction - mean_);
}

glm::dvec3 DriftLine::velocity_deg_s() const {
  return squares_s2_ > 0.0 ? glm::degrees(1.0) / squares_s2_ * products_ : glm::dvec3(0.0);
}

double DriftLine::velocityVariance_deg2_s2(double noise_deg) const {
  return squares_s2_ > 0.0 ? noise_deg * noise_deg / squares_s2_ : 0.0;
}

double DriftLine::velocityError_deg_s(double noise_deg) const {
  constexpr double kUnknown_deg_s = 1e3;
  return squares_s2_ > 0.0 ? noise_deg / std::sqrt(squares_s2_) : kUnknown_deg_s;
}

double DriftLine::distance_deg(double noise_deg) const {
  // The squared distance between two noisy samples is chi-square distributed (two axes): 95 % of
  // its values are below three times its mean.
  constexpr double kDistance95 = 3.0;
  const double mean_deg2 = 4.0 * noise_deg * noise_deg;
  const double distance_deg = glm::degrees(glm::distance(first_, newest_));
  return std::sqrt(std::max(distance_deg * distance_deg - kDistance95 * mean_deg2, 0.0));
}

double DriftLine::variance_deg2() const {
  return count_ > 0.0 ? std::pow(glm::degrees(1.0), 2) * squares_ / count_ : 0.0;
}

double DriftLine::straightness() const {
  const glm::dvec3 velocity = velocity_deg_s();
  const double explained_deg2 = glm::dot(velocity, velocity) * squares_s2_ / std::max(count_, 1.0);
  return std::min(explained_deg2 / (variance_deg2() + 1e-6), 1.0);
}

double DriftLine::agreement(const DriftLine& other, double noise_deg, double still_deg_s) const {
  const glm::dvec3 u = velocity_deg_s(), v = other.velocity_deg_s();
  return glm::dot(u, v) /
         (glm::length(u) * glm::length(v) + still_deg_s * still_deg_s +
          velocityVariance_deg2_s2(noise_deg) + other.velocityVariance_deg2_s2(noise_deg));
}

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
