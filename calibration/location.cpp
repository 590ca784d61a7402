#include "calibration/location.h"

#include <cassert>
#include <cmath>

#include "base/quantile.h"

namespace foci {
namespace {

constexpr int kIterations = 8;  // chosen by hand; each shrinks the remaining step several times

}  // namespace

RobustLocation robustLocation(std::span<const glm::dvec2> samples,
                              std::span<const double> weights) {
  assert(!samples.empty());
  RobustLocation location;
  std::vector<double> values(samples.size());
  glm::dvec2 scale;
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < samples.size(); ++i) values[i] = samples[i][axis];
    location.centre[axis] = quantile(values, 0.5);
    for (double& value : values) value = std::abs(value - location.centre[axis]);
    scale[axis] = kSigmaPerMad * quantile(values, 0.5);
  }
  location.sd = scale;
  // If more than half of the samples are equal, they are the location.
  scale = glm::max(scale, glm::dvec2(1e-12));

  for (int iteration = 0; iteration < kIterations; ++iteration) {
    glm::dvec2 sum{0.0};
    double total = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const glm::dvec2 step = samples[i] - location.centre;
      const glm::dvec2 relative = step / (kTukey * scale);
      const double r2 = glm::dot(relative, relative);
      if (r2 >= 1.0) continue;
      const double w = (weights.empty() ? 1.0 : weights[i]) * (1.0 - r2) * (1.0 - r2);
      total += w;
      sum += w * step;
    }
    if (total <= 0.0) break;
    location.centre += sum / total;
  }
  return location;
}

}  // namespace foci
