// A simulated observer and tracker with known truth.
#pragma once

#include <random>
#include <vector>

#include "calibration/gaze_map/map_units.h"

namespace foci {

struct SimulatedUser {
  glm::dvec2 offset{1.2, -0.8};
  glm::dmat2 linear{1.06, -0.03, 0.04, 0.95};
  std::array<glm::dvec2, 3> square{};  ///< deg at 12 deg: x^2, xy, y^2
  std::array<glm::dvec2, 4> cube{};    ///< x^3, x^2 y, x y^2, y^3
  double noise_deg = 0.0;              ///< of each sample, per axis
  double outliers = 0.0;               ///< share of samples anywhere within 10 deg
  double target_sd_deg = 0.0;          ///< how far beside each target the observer looks

  glm::dvec2 tracked(const glm::dvec2& gaze_deg) const {
    const double x = gaze_deg.x / 12.0, y = gaze_deg.y / 12.0;
    return linear * gaze_deg + offset + square[0] * x * x + square[1] * x * y + square[2] * y * y +
           cube[0] * x * x * x + cube[1] * x * x * y + cube[2] * x * y * y + cube[3] * y * y * y;
  }
};

inline std::vector<glm::dvec2> targetGrid(int side, double half_deg) {
  std::vector<glm::dvec2> targets;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      targets.push_back(
          {half_deg * (2.0 * i / (side - 1) - 1.0), 0.7 * half_deg * (2.0 * j / (side - 1) - 1.0)});
    }
  }
  return targets;
}

/// @param slipped  index of a target at which the observer looked `slip_deg` beside it; -1: none
inline std::vector<GazePair> recordUser(const SimulatedUser& user,
                                        const std::vector<glm::dvec2>& targets, int samples,
                                        std::mt19937_64& random, int slipped = -1,
                                        glm::dvec2 slip_deg = {4.0, -2.0}) {
  // std distributions differ between libraries; these tests hold for any of them.
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<GazePair> pairs;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    glm::dvec2 looked_at =
        targets[t] + user.target_sd_deg * glm::dvec2{gauss(random), gauss(random)};
    if (static_cast<int>(t) == slipped) looked_at += slip_deg;
    for (int i = 0; i < samples; ++i) {
      GazePair pair;
      pair.target = targets[t];
      glm::dvec2 gaze = looked_at + user.noise_deg * glm::dvec2{gauss(random), gauss(random)};
      if (0.5 * (uniform(random) + 1.0) < user.outliers) {
        gaze = targets[t] + 10.0 * glm::dvec2{uniform(random), uniform(random)};
      }
      pair.gaze = user.tracked(gaze);
      pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace foci
