#include "calibration/gaze_map/stations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/input_error.h"
#include "base/quantile.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr std::size_t kMinTargets = 3, kMaxTargets = 10'000;
// Chosen by hand; the tests FitGazeMapping.Refuses... bound them.
constexpr double kCollinear = 0.02;  // smaller over larger extent of the targets or of the gaze
constexpr double kScattered = 0.35;  // deviation at one target over the extent of the gaze

std::string pointText(const glm::dvec2& point) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.4g, %.4g)", point.x, point.y);
  return text;
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
  const std::vector<Station> all = kept;
  drop([&](const Station& s) {
    return std::any_of(all.begin(), all.end(), [&](const Station& other) {
      return other.gaze == s.gaze && other.target != s.target;
    });
  });
  if (kept.size() < kMinTargets || 2 * kept.size() < stations.size()) return {};
  stations = std::move(kept);
  std::vector<glm::dvec2> targets;
  targets.reserve(dropped.size());
  for (const Station& s : dropped) targets.push_back(s.target);
  return targets;
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
