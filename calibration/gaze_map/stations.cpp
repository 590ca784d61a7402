#include "calibration/gaze_map/stations.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "base/transformed.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr std::size_t kMinTargets = 3, kMaxTargets = 10'000;
// Chosen by hand; the tests FitGazeMapping.Refuses... bound them.
constexpr double kCollinear = 0.02;  // smaller over larger extent of the targets or of the gaze
constexpr double kScattered = 0.35;  // deviation at one target over the extent of the gaze
/// Gaze at two targets lies as near as this share of what the tracker's usual gain makes of their
/// distance: one gaze at two targets.
constexpr double kTwins = 0.15;

std::string pointText(const glm::dvec2& point) {
  return "(" + significant(point.x) + ", " + significant(point.y) + ")";
}

}  // namespace

void refuseGazeCalibration(const std::string& why) { throw InputError("gaze calibration", why); }

std::vector<Station> stationsOf(std::span<const GazePair> pairs, const GazeFrame& frame) {
  std::map<std::pair<double, double>, std::pair<Station, std::vector<double>>> by_target;
  for (const GazePair& pair : pairs) {
    if (!pair.gaze || pair.weight <= 0.0) continue;
    auto& [station, weights] = by_target[{pair.target.x, pair.target.y}];
    station.target = pair.target;
    station.samples.push_back(*pair.gaze);
    weights.push_back(pair.weight);
  }
  std::vector<Station> stations;
  std::vector<double> totals;
  for (auto& [key, value] : by_target) {
    auto& [station, weights] = value;
    const RobustLocation location = robustLocation(station.samples, weights);
    station.gaze = location.centre;
    station.gaze_sd = location.sd;
    station.deg_per_unit = degPerUnit(frame, station.target);
    station.weight = 0.0;
    for (double w : weights) station.weight += w;
    totals.push_back(station.weight);
    stations.push_back(std::move(station));
  }
  if (stations.size() > kMaxTargets) refuseGazeCalibration("more than 10000 different targets");
  if (stations.empty()) refuseGazeCalibration("no sample with gaze at any target");
  // Samples of one target share the observer's error there, so more samples add little certainty.
  const double usual = quantile(totals, 0.5);
  for (Station& s : stations) s.weight = std::clamp(s.weight / usual, 0.1, 1.0);
  return stations;
}

glm::dvec2 extents(std::span<const Station> stations, glm::dvec2 Station::*point) {
  glm::dvec2 mean{0.0};
  for (const Station& s : stations) mean += s.*point / static_cast<double>(stations.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Station& s : stations) {
    const glm::dvec2 d = s.*point - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double half = 0.5 * (xx + yy);
  const double root = std::sqrt(std::max(half * half - (xx * yy - xy * xy), 0.0));
  const double n = static_cast<double>(stations.size());
  return {std::sqrt(std::max(half - root, 0.0) / n), std::sqrt((half + root) / n)};
}

namespace {

bool isScattered(const Station& station, double extent) {
  return station.samples.size() > 1 && glm::length(station.gaze_sd) > kScattered * extent;
}

/// Units of gaze for one unit between targets, along the axis where the tracker gains less.
double gainOf(std::span<const Station> stations) {
  const glm::dvec2 gaze = extents(stations, &Station::gaze);
  const glm::dvec2 targets = extents(stations, &Station::target);
  return targets.x > 0.0 ? std::min(gaze.x / targets.x, gaze.y / targets.y) : 0.0;
}

bool areTwins(const Station& a, const Station& b, double gain) {
  return a.target != b.target &&
         glm::distance(a.gaze, b.gaze) <= kTwins * gain * glm::distance(a.target, b.target);
}

/// An affine map from (1, gaze) to targets, through the stations; absent where they do not
/// determine one.
std::optional<Eigen::Matrix<double, 3, 2>> affineThrough(std::span<const Station> stations) {
  const auto n = static_cast<Eigen::Index>(stations.size());
  Eigen::MatrixXd design(n, 3), goal(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Station& s = stations[static_cast<std::size_t>(i)];
    design.row(i) << 1.0, s.gaze.x, s.gaze.y;
    goal.row(i) << s.target.x, s.target.y;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(design);
  if (factor.rank() < 3) return std::nullopt;
  return factor.solve(goal);
}

/// The targets that share their gaze with another one, but for the one that was looked at: the
/// nearest to where the other stations put this gaze.
std::vector<glm::dvec2> falseTwins(std::span<const Station> stations) {
  const double gain = gainOf(stations);
  std::vector<Station> twins, others;
  for (const Station& s : stations) {
    const bool is_twin = std::ranges::any_of(
        stations, [&](const Station& other) { return areTwins(s, other, gain); });
    (is_twin ? twins : others).push_back(s);
  }
  const auto map = twins.empty() ? std::nullopt : affineThrough(others);
  std::vector<glm::dvec2> targets;
  for (const Station& s : twins) {
    const auto missed = [&](const Station& station) {
      const Eigen::RowVector2d seen = Eigen::RowVector3d(1.0, s.gaze.x, s.gaze.y) * *map;
      return glm::distance(station.target, glm::dvec2(seen[0], seen[1]));
    };
    const bool is_false = std::ranges::any_of(twins, [&](const Station& other) {
      return areTwins(s, other, gain) && !(map && missed(s) < missed(other));
    });
    if (is_false) targets.push_back(s.target);
  }
  return targets;
}

}  // namespace

std::vector<glm::dvec2> dropBadTargets(std::vector<Station>& stations) {
  // A wild target widens the extent of the gaze, and so hides others: judge again without it.
  std::vector<Station> kept = stations, dropped;
  const auto drop = [&](const auto& isBad) {
    const auto end = std::stable_partition(kept.begin(), kept.end(),
                                           [&](const Station& s) { return !isBad(s); });
    const auto count = static_cast<std::size_t>(kept.end() - end);
    dropped.insert(dropped.end(), end, kept.end());
    kept.erase(end, kept.end());
    return count;
  };
  while (!kept.empty()) {
    const double extent = glm::length(extents(kept, &Station::gaze));
    if (drop([&](const Station& s) { return isScattered(s, extent); }) == 0) break;
  }
  const std::vector<glm::dvec2> twins = falseTwins(kept);
  drop([&](const Station& s) { return std::ranges::find(twins, s.target) != twins.end(); });
  if (kept.size() < kMinTargets || 2 * kept.size() < stations.size()) return {};
  stations = std::move(kept);
  return transformed(dropped, &Station::target);
}

void refuseUnusable(std::span<const Station> stations) {
  if (stations.size() < kMinTargets) {
    refuseGazeCalibration("too few targets: gaze at " + std::to_string(stations.size()) +
                          " different ones, 3 or more that are not in a line are needed");
  }
  const glm::dvec2 targets = extents(stations, &Station::target);
  if (targets.x <= kCollinear * targets.y)
    refuseGazeCalibration("the targets are collinear: no second direction");
  const glm::dvec2 gaze = extents(stations, &Station::gaze);
  if (gaze.y <= 1e-9 * (1.0 + glm::length(stations[0].gaze)))
    refuseGazeCalibration("contradictory: gaze is the same at every target");
  if (gaze.x <= kCollinear * gaze.y)
    refuseGazeCalibration("gaze moves along a line only: is one axis lost?");
  for (const Station& s : stations) {
    if (isScattered(s, glm::length(gaze))) {
      refuseGazeCalibration(
          "contradictory: the samples of target " + pointText(s.target) +
          " lie as far apart as the targets do, and too few other targets remain");
    }
    for (const Station& other : stations) {
      if (&other == &s) break;
      if (s.gaze == other.gaze) {
        refuseGazeCalibration("contradictory: the same gaze at targets " + pointText(other.target) +
                              " and " + pointText(s.target));
      }
    }
  }
}

}  // namespace foci
