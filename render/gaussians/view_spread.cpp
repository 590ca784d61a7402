#include "render/gaussians/view_spread.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "render/image/visible_difference.h"

namespace foci {

void ViewSpread::begin(int samples, int apron) {
  places_.clear();
  const int inside = samples - 2 * apron, along = std::min(inside, kAlong);
  const auto placeOf = [&](int i) {
    const int place = apron + (2 * i + 1) * inside / (2 * along);
    return static_cast<std::size_t>(place);
  };
  for (int y = 0; y < along; ++y) {
    for (int x = 0; x < along; ++x) places_.push_back(placeOf(y) * rowOf(samples) + placeOf(x));
  }
  values_.clear();
  sums_.assign(places_.size(), glm::vec3(0.0f));
}

void ViewSpread::add(const TileSums& sums) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::size_t at = places_[i];
    const glm::vec3 sum(sums.red[at], sums.green[at], sums.blue[at]);
    values_.push_back(sum - sums_[i]);
    sums_[i] = sum;
  }
}

SampledErrors ViewSpread::standardErrors() const {
  const std::size_t views = values_.size() / places_.size();
  assert(views >= 2);
  const auto n = static_cast<float>(views);
  SampledErrors errors{.count = places_.size()};
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const glm::vec3 mean = sums_[i] / n;
    const glm::mat3 jnd = visibleDifferencePerLight(mean);
    float sum = 0.0f;
    for (std::size_t at = i; at < values_.size(); at += places_.size()) {
      const glm::vec3 apart = jnd * (values_[at] - mean);
      sum += glm::dot(apart, apart);
    }
    errors.jnd[i] = std::sqrt(sum / (n * (n - 1.0f)));
  }
  return errors;
}

}  // namespace foci
