#include "calibration/gaze_map/accuracy.h"

#include <cmath>
#include <map>

namespace foci {
namespace {

/// Sums from which the measures of one target or of all targets follow.
struct Sums {
  std::size_t rows = 0, missing = 0, pairs = 0, within = 0;
  glm::dvec2 axes{0.0};
  double angle = 0.0, step2 = 0.0, spread2 = 0.0, uncertainty = 0.0;

  void add(const Sums& other) {
    rows += other.rows;
    missing += other.missing;
    pairs += other.pairs;
    within += other.within;
    axes += other.axes;
    angle += other.angle;
    step2 += other.step2;
    spread2 += other.spread2;
    uncertainty += other.uncertainty;
  }

  GazeMeasures measures(bool mapped) const {
    GazeMeasures m{.samples = rows, .missing = missing};
    const std::size_t count = rows - missing;
    const auto valid = static_cast<double>(count);
    if (count > 0) {
      m.accuracy_deg = angle / valid;
      m.axes_deg = axes / valid;
    }
    if (count > 0 && mapped) {
      m.uncertainty_deg = uncertainty / valid;
      m.within = static_cast<double>(within) / valid;
    }
    if (pairs > 0) {
      m.rms_s2s_deg = std::sqrt(step2 / static_cast<double>(pairs));
      m.sd_deg = std::sqrt(spread2 / valid);
    }
    return m;
  }
};

}  // namespace

std::string_view nameOf(Grade grade) {
  switch (grade) {
    case Grade::good:
      return "good";
    case Grade::fair:
      return "fair";
    case Grade::poor:
      return "poor";
  }
  return "poor";
}

GazeAccuracy measureAccuracy(std::span<const GazePair> pairs, const GazeFrame& frame,
                             const GazeMap* map) {
  struct AtTarget {
    Sums sums;
    glm::dvec2 total{0.0};
    std::vector<glm::dvec2> seen;  // on the plane z = 1
  };
  std::vector<AtTarget> at;
  GazeAccuracy result;
  std::map<std::pair<double, double>, std::size_t> index;
  std::optional<glm::dvec2> previous;
  std::size_t previous_target = 0;
  for (const GazePair& pair : pairs) {
    const auto [found, fresh] = index.try_emplace({pair.target.x, pair.target.y}, at.size());
    if (fresh) {
      at.emplace_back();
      result.targets.push_back({.target = pair.target});
    }
    AtTarget& here = at[found->second];
    ++here.sums.rows;
    if (!pair.gaze) {
      ++here.sums.missing;
      previous.reset();
      continue;
    }
    glm::dvec2 point = *pair.gaze;
    double uncertainty = 0.0;
    if (map) {
      const GazeEstimate estimate = estimateGaze(*map, point);
      point = estimate.point;
      uncertainty = estimate.uncertainty_deg;
    }
    const glm::dvec2 seen = onPlane(frame, point), target = onPlane(frame, pair.target);
    const double error = angle_deg(seen, target);
    here.sums.angle += error;
    here.sums.axes += glm::abs(glm::degrees(glm::atan(seen) - glm::atan(target)));
    here.sums.uncertainty += uncertainty;
    here.sums.within += error <= uncertainty;
    if (previous && previous_target == found->second) {
      const double step = angle_deg(*previous, seen);
      here.sums.step2 += step * step;
      ++here.sums.pairs;
    }
    previous = seen;
    previous_target = found->second;
    here.total += seen;
    here.seen.push_back(seen);
  }

  Sums all;
  for (std::size_t i = 0; i < at.size(); ++i) {
    AtTarget& here = at[i];
    if (!here.seen.empty()) {
      const glm::dvec2 mean = here.total / static_cast<double>(here.seen.size());
      for (const glm::dvec2& seen : here.seen) {
        const double angle = angle_deg(seen, mean);
        here.sums.spread2 += angle * angle;
      }
      result.targets[i].mean = fromPlane(frame, mean);
    }
    const GazeMeasures measures = here.sums.measures(map != nullptr);
    result.targets[i].measures = measures;
    if (measures.accuracy_deg) {
      result.worst_deg = std::max(result.worst_deg.value_or(0.0), *measures.accuracy_deg);
    }
    all.add(here.sums);
  }
  result.overall = all.measures(map != nullptr);
  return result;
}

Grade gradeOf(const GazeAccuracy& accuracy) {
  if (!accuracy.overall.accuracy_deg) return Grade::poor;
  const double mean = *accuracy.overall.accuracy_deg, worst = *accuracy.worst_deg;
  if (mean < 1.0 && worst < 1.5) return Grade::good;
  return mean <= 1.5 && worst <= 2.0 ? Grade::fair : Grade::poor;
}

}  // namespace foci
