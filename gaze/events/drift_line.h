// A straight line through directions over time: how gaze moves between two saccades.
#pragma once

#include <glm/glm.hpp>

namespace foci {

/// The least-squares line through directions, and what it leaves unexplained. The memory does not
/// grow with the samples.
class DriftLine {
 public:
  void add(double time_s, const glm::dvec3& direction);

  double count() const { return count_; }
  double first_s() const { return first_s_; }
  double newest_s() const { return newest_s_; }
  double duration_s() const { return newest_s_ - first_s_; }
  const glm::dvec3& first() const { return first_; }
  const glm::dvec3& newest() const { return newest_; }

  glm::dvec3 velocity_deg_s() const;
  /// Standard error of the velocity along each axis.
  /// @param noise_deg  standard deviation of a sample's error along each axis
  double velocityError_deg_s(double noise_deg) const;
  /// Distance from the first to the newest sample, without what noise explains.
  double distance_deg(double noise_deg) const;
  /// Mean squared distance from the mean direction.
  double variance_deg2() const;
  /// Share of the samples' variance that the line explains, 0 to 1.
  double straightness() const;

  /// The cosine between two velocities u and v, less if noise or stillness leaves their directions
  /// open: u.v / (|u| |v| + still^2 + var(u) + var(v)).
  /// @param still_deg_s  slower motion has hardly a direction
  double agreement(const DriftLine& other, double noise_deg, double still_deg_s) const;

 private:
  double velocityVariance_deg2_s2(double noise_deg) const;

  double count_ = 0.0;
  double first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0}, mean_{0.0};
  double squares_ = 0.0;                    // sum of squared distances from the mean, rad^2
  double mean_s_ = 0.0, squares_s2_ = 0.0;  // mean of the times, and their squares around it
  glm::dvec3 products_{0.0};                // sum of the products of time and direction around it
};

}  // namespace foci
