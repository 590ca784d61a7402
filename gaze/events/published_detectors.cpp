#include "gaze/events/published_detectors.h"

#include <algorithm>
#include <cmath>

#include "gaze/events/sight_noise.h"

namespace foci {

std::vector<GazeState> labelByVelocity(std::span<const TimedSight> sights, double rate_Hz,
                                       double saccade_deg_s) {
  const auto velocities = velocitiesOfSight(sights, kVelocityWindow_s, longestStep_s(rate_Hz));
  std::vector<GazeState> states(sights.size(), GazeState::fixation);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (!sights[i].direction) {
      states[i] = GazeState::blink;
    } else if (velocities[i] && velocities[i]->speed_deg_s >= saccade_deg_s) {
      states[i] = GazeState::saccade;
    }
  }
  return states;
}

std::vector<GazeState> labelByDispersion(std::span<const TimedSight> sights) {
  constexpr double kDispersion_deg = 1.0, kSlack_s = 1e-6;
  std::vector<GazeState> states(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    states[i] = sights[i].direction ? GazeState::saccade : GazeState::blink;
  }
  std::size_t labelled = 0;  // samples before it have their label from an earlier window
  for (std::size_t first = 0; first < sights.size(); ++first) {
    glm::dvec2 least(INFINITY), most(-INFINITY);
    std::size_t end = first;
    for (; end < sights.size(); ++end) {
      const double since_s = sights[end].time_s - sights[first].time_s;
      if (since_s > kDispersionWindow_s + kSlack_s) break;
      if (!sights[end].direction) continue;
      const glm::dvec3& sight = *sights[end].direction;
      const glm::dvec2 angles_deg = glm::degrees(
          glm::dvec2(std::atan2(sight.x, -sight.z), std::asin(std::clamp(sight.y, -1.0, 1.0))));
      least = glm::min(least, angles_deg);
      most = glm::max(most, angles_deg);
    }
    const bool is_complete = end < sights.size() || sights[end - 1].time_s - sights[first].time_s >=
                                                        kDispersionWindow_s - kSlack_s;
    const glm::dvec2 extent_deg = most - least;
    if (!is_complete || !(extent_deg.x + extent_deg.y <= kDispersion_deg)) continue;
    for (std::size_t i = std::max(first, labelled); i < end; ++i) {
      if (sights[i].direction) states[i] = GazeState::fixation;
    }
    labelled = end;
  }
  return states;
}

}  // namespace foci
