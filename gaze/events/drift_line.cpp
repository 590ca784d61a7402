#include "gaze/events/drift_line.h"

#include <algorithm>
#include <cmath>

namespace foci {

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

}  // namespace foci
