#include "gaze/events/pursuit_features.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {
namespace {

constexpr double kStill_deg_s = 3.0;  // slower motion has hardly a direction

/// The cosine between two velocities, less if noise or stillness leaves their directions open.
double directionAgreement(const glm::dvec3& u, double u_error, const glm::dvec3& v,
                          double v_error) {
  return glm::dot(u, v) / (glm::length(u) * glm::length(v) + kStill_deg_s * kStill_deg_s +
                           u_error * u_error + v_error * v_error);
}

/// Agreement, speed and distance of a neighbour, and the saccade between the two.
void addNeighbour(const DriftLine& whole, const DriftLine* other, double noise_deg, bool is_before,
                  float*& out) {
  if (!other || other->count() < 3.0) {
    for (int i = 0; i < 6; ++i) *out++ = -5.0F;
    return;
  }
  const glm::dvec3 u = whole.velocity_deg_s(), v = other->velocity_deg_s();
  const glm::dvec3 jump =
      glm::degrees(is_before ? whole.first() - other->newest() : other->first() - whole.newest());
  const double jump_deg = glm::length(jump), speed_deg_s = glm::length(u);
  *out++ = static_cast<float>(directionAgreement(u, whole.velocityError_deg_s(noise_deg), v,
                                                 other->velocityError_deg_s(noise_deg)));
  *out++ = static_cast<float>(std::log(glm::length(v) + 0.3));
  *out++ = static_cast<float>(std::log(other->distance_deg(noise_deg) + 0.1));
  *out++ = static_cast<float>(other->straightness());
  *out++ = static_cast<float>(std::log(jump_deg + 0.1));
  *out++ = static_cast<float>(glm::dot(jump, u) / (jump_deg * speed_deg_s + 0.5 * kStill_deg_s));
}

}  // namespace

void DriftLine::add(double time_s, const glm::dvec3& direction) {
  if (count_ == 0.0) {
    first_s_ = time_s;
    first_ = direction;
  }
  newest_s_ = time_s;
  newest_ = direction;
  const double t = time_s - first_s_;
  const glm::dvec3 x = direction - first_;
  count_ += 1.0;
  time_ += t;
  times_ += t * t;
  sum_ += x;
  product_ += t * x;
  squares_ += glm::dot(x, x);
}

glm::dvec3 DriftLine::velocity_deg_s() const {
  const double spread = count_ * times_ - time_ * time_;
  if (!(spread > 0.0)) return glm::dvec3(0.0);
  return glm::degrees(1.0) / spread * (count_ * product_ - time_ * sum_);
}

double DriftLine::velocityError_deg_s(double noise_deg) const {
  const double spread = times_ - time_ * time_ / std::max(count_, 1.0);
  return spread > 0.0 ? noise_deg / std::sqrt(spread) : 1e3;
}

double DriftLine::variance_deg2() const {
  if (count_ < 1.0) return 0.0;
  const glm::dvec3 mean = sum_ / count_;
  return std::pow(glm::degrees(1.0), 2) * std::max(squares_ / count_ - glm::dot(mean, mean), 0.0);
}

double DriftLine::distance_deg(double noise_deg) const {
  const double distance_deg = glm::degrees(glm::distance(first_, newest_));
  // 95 % of the squared distances between two noisy samples are below three times their mean.
  return std::sqrt(std::max(distance_deg * distance_deg - 12.0 * noise_deg * noise_deg, 0.0));
}

double DriftLine::spread_deg(double noise_deg) const {
  return std::sqrt(std::max(variance_deg2() - 2.0 * noise_deg * noise_deg, 0.0));
}

double DriftLine::straightness() const {
  const double spread_s2 =
      times_ / std::max(count_, 1.0) - std::pow(time_ / std::max(count_, 1.0), 2);
  const glm::dvec3 velocity = velocity_deg_s();
  return std::min(glm::dot(velocity, velocity) * spread_s2 / (variance_deg2() + 1e-6), 1.0);
}

PursuitFeatureVector pursuitFeatures(const StableContext& context) {
  PursuitFeatureVector features{};
  float* out = features.data();
  const auto add = [&](double value) { *out++ = static_cast<float>(value); };
  const DriftLine& whole = *context.whole;
  const double noise_deg = context.noise_deg;
  const glm::dvec3 velocity = whole.velocity_deg_s();
  const double error = whole.velocityError_deg_s(noise_deg);
  const double speed_deg_s = glm::length(velocity);
  add(std::log(whole.duration_s() + 0.01));
  add(std::log(whole.distance_deg(noise_deg) + 0.1));
  add(std::log(whole.spread_deg(noise_deg) + 0.05));
  add(std::log(speed_deg_s + 0.3));
  add(std::log(speed_deg_s / error + 0.1));
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
    const glm::dvec3 local = line.velocity_deg_s();
    const double local_error = line.velocityError_deg_s(noise_deg);
    add(std::log(glm::length(local) + 0.3));
    add(std::log(glm::length(local) / local_error + 0.1));
    add(directionAgreement(local, local_error, velocity, error));
    add(line.straightness());
  }
  addNeighbour(whole, context.before, noise_deg, true, out);
  addNeighbour(whole, context.after, noise_deg, false, out);
  if (context.before_that && context.before_that->count() >= 3.0) {
    add(directionAgreement(velocity, error, context.before_that->velocity_deg_s(),
                           context.before_that->velocityError_deg_s(noise_deg)));
  } else {
    add(-5.0);
  }
  add(std::log(context.time_s - whole.first_s() + 0.01));
  add(std::log(std::max(whole.newest_s() - context.time_s, 0.0) + 0.01));
  assert(out == features.data() + kPursuitFeatures);
  return features;
}

}  // namespace foci
