#include "app/replay/moving_observer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/quantile.h"
#include "gaze/events/pursuit.h"

namespace foci {
namespace {

/// By axis.
std::optional<glm::dvec3> medianPoint_m(std::span<const SightSample> samples) {
  std::vector<double> axis;
  glm::dvec3 median(0.0);
  for (int k = 0; k < 3; ++k) {
    axis.clear();
    for (const SightSample& sample : samples) {
      if (sample.hit) axis.push_back(sample.hit->point_m[k]);
    }
    if (axis.empty()) return std::nullopt;
    median[k] = quantile(axis, 0.5);
  }
  return median;
}

/// Standard deviation of a direction along each axis, degrees, from the steps between samples.
double noiseOf_deg(std::span<const glm::dvec3> directions) {
  double squares = 0.0;
  for (std::size_t i = 1; i < directions.size(); ++i) {
    const glm::dvec3 step = directions[i] - directions[i - 1];
    squares += glm::dot(step, step);
  }
  const auto steps = static_cast<double>(std::max<std::size_t>(directions.size(), 2) - 1);
  return glm::degrees(std::sqrt(0.25 * squares / steps));
}

bool restsOnAPoint(std::span<const SightSample> samples, const EventRules& rules) {
  const auto point_m = medianPoint_m(samples);
  if (!point_m) return false;
  const bool moves = std::any_of(samples.begin(), samples.end(), [&](const SightSample& sample) {
    return sample.origin_m != samples.front().origin_m;
  });
  if (!moves) return false;
  const auto towards = [&](const SightSample& sample) {
    return glm::normalize(*point_m - sample.origin_m);
  };
  std::vector<glm::dvec3> directions;
  StableGaze gaze;
  const glm::dvec3 middle = towards(samples[samples.size() / 2]);
  for (const SightSample& sample : samples) {
    if (!sample.valid) continue;
    directions.push_back(glm::normalize(sample.direction - towards(sample) + middle));
    gaze.add(sample.time_s, directions.back());
  }
  return directions.size() > 1 && !gaze.isPursuit(noiseOf_deg(directions), rules);
}

}  // namespace

void fixateRestingPoints(std::vector<GazeEvent>& events, std::span<SightSample> samples,
                         const EventRules& rules) {
  for (GazeEvent& event : events) {
    if (event.kind != GazeState::pursuit) continue;
    const std::span<SightSample> during = samplesDuring(event, samples);
    if (!restsOnAPoint(during, rules)) continue;
    event.kind = GazeState::fixation;
    for (SightSample& sample : during) {
      if (sample.state == GazeState::pursuit) sample.state = GazeState::fixation;
    }
  }
}

}  // namespace foci
