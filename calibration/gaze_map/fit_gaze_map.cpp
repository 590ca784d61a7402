#include "calibration/gaze_map/fit_gaze_map.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/input_error.h"
#include "base/quantile.h"
#include "calibration/gaze_map/station_fit.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr std::size_t kMinTargets = 3, kMaxTargets = 10'000;
constexpr double kCollinear = 0.02;   // smaller over larger extent of the targets or of the gaze
constexpr double kScattered = 0.35;   // deviation at one target over the extent of the gaze
constexpr double kUnexplained = 0.4;  // median held-out error over the extent of the targets
constexpr double kBounded = 3.0;      // a held-out error counts up to so many times the median
/// Error variance that the next order must leave at most, by order.
constexpr std::array<double, 4> kGain{1.0, 0.95, 0.8, 0.8};
/// Power of the ratio of error variances by which two fits share the coefficients.
constexpr double kTrust = 2.0;
/// Prior precision of the powers above the affine, over the noise's.
constexpr std::array<double, 3> kShrinkage{0.03, 0.3, 3.0};

/// All samples of one target.
struct Station {
  glm::dvec2 target{0.0};
  glm::dvec2 gaze{0.0};
  glm::dvec2 gaze_sd{0.0};
  glm::dvec2 deg_per_unit{1.0};
  double weight = 1.0;
  std::vector<glm::dvec2> samples;
};

[[noreturn]] void refuse(const std::string& why) { throw InputError("gaze calibration", why); }

std::string pointText(const glm::dvec2& point) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.4g, %.4g)", point.x, point.y);
  return text;
}

/// Smaller and larger standard deviation of a cloud along its own axes.
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
  if (stations.size() > kMaxTargets) refuse("more than 10000 different targets");
  if (stations.empty()) refuse("no sample with gaze at any target");
  // Samples of one target share the observer's error there: more of them hardly make it surer.
  const double usual = quantile(totals, 0.5);
  for (Station& s : stations) s.weight = std::clamp(s.weight / usual, 0.1, 1.0);
  return stations;
}

void refuseHopeless(std::span<const Station> stations) {
  if (stations.size() < kMinTargets) {
    refuse("too few targets: gaze at " + std::to_string(stations.size()) +
           " different ones, 3 or more that are not in a line are needed");
  }
  const glm::dvec2 targets = extents(stations, &Station::target);
  if (targets.x <= kCollinear * targets.y) refuse("the targets are collinear: no second direction");
  const glm::dvec2 gaze = extents(stations, &Station::gaze);
  if (gaze.y <= 1e-9 * (1.0 + glm::length(stations[0].gaze)))
    refuse("contradictory: gaze is the same at every target");
  if (gaze.x <= kCollinear * gaze.y) refuse("gaze moves along a line only: is one axis lost?");
  for (const Station& s : stations) {
    if (s.samples.size() > 1 && glm::length(s.gaze_sd) > kScattered * glm::length(gaze)) {
      refuse("contradictory: the samples of target " + pointText(s.target) +
             " lie as far apart as the targets do");
    }
    for (const Station& other : stations) {
      if (&other == &s) break;
      if (s.gaze == other.gaze) {
        refuse("contradictory: the same gaze at targets " + pointText(other.target) + " and " +
               pointText(s.target));
      }
    }
  }
}

/// Error that a station would have had, had it not been fitted: r / (1 - h).
double heldOut_deg(const StationSolution& solution, Eigen::Index i) {
  return solution.residual.row(i).norm() / (1.0 - solution.leverage[i]);
}

struct Candidate {
  StationSystem system;
  StationSolution solution;
  double score = 0.0;  // deg^2
};

bool bears(GazeModel model, std::size_t stations) {
  constexpr std::array<std::size_t, 4> kFewest{1, 4, 8, 13};
  return stations >= kFewest[static_cast<std::size_t>(model)];
}

/// Radius, in deviations per axis, with 68.27 % of the held-out errors of single samples. Few
/// targets say little of it: the Gaussian's own radius counts as so many targets more.
double sigmaRadius(const StationSolution& solution, std::span<const Station> stations,
                   const glm::dvec2& slope, double sample_variance) {
  // Two axes and a deviation estimated with nu degrees: r^2 / (2 sd^2) is F(2, nu).
  const double nu = std::max(2.0 * solution.freedom, 1.0);
  const double gaussian = std::sqrt(nu * (std::pow(1.0 - 0.6827, -2.0 / nu) - 1.0));
  constexpr double kPriorTargets = 9.0;
  constexpr std::size_t kMaxSamples = 64;
  std::vector<double> ratios;
  double targets = 0.0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (solution.weight[row] <= 0.0) continue;
    const Station& s = stations[i];
    const double h = solution.leverage[row];
    const double sd = std::sqrt(solution.sd_deg * solution.sd_deg / (1.0 - h) + sample_variance);
    const glm::dvec2 miss =
        glm::dvec2(solution.residual(row, 0), solution.residual(row, 1)) / (1.0 - h);
    const std::size_t step = s.samples.size() / kMaxSamples + 1;
    for (std::size_t k = 0; k < s.samples.size(); k += step) {
      const glm::dvec2 scatter = (s.samples[k] - s.gaze) * slope * s.deg_per_unit;
      ratios.push_back(glm::length(miss - scatter) / sd);
    }
    targets += 1.0;
  }
  if (ratios.empty()) return gaussian;
  const double found = quantile(ratios, 0.6827);
  return (found * targets + gaussian * kPriorTargets) / (targets + kPriorTargets);
}

}  // namespace

GazeFit fitGazeMap(std::span<const GazePair> pairs, const GazeFrame& frame,
                   std::optional<GazeModel> forced) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Station> stations = stationsOf(pairs, frame);
  refuseHopeless(stations);
  const auto n = static_cast<Eigen::Index>(stations.size());

  // Normalise gaze so that the targets lie at about |u| <= 1, whatever strays.
  GazeFit fit;
  GazeMap& map = fit.map;
  map.frame = frame;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> values(stations.size());
    for (std::size_t i = 0; i < stations.size(); ++i) values[i] = stations[i].gaze[axis];
    map.centre[axis] = quantile(values, 0.5);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      values[i] = std::abs(stations[i].gaze[axis] - map.centre[axis]);
    }
    const double usual = quantile(values, 0.5);
    double largest = usual;
    for (double v : values) {
      if (v <= 4.0 * usual) largest = std::max(largest, v);
    }
    map.scale[axis] = largest > 0.0 ? largest : *std::max_element(values.begin(), values.end());
    if (map.scale[axis] <= 0.0) refuse("gaze does not move along one axis");
  }

  // Fit every order that the targets bear, the powers more or less shrunk.
  std::vector<Candidate> candidates;
  for (GazeModel model :
       {GazeModel::offset, GazeModel::affine, GazeModel::second, GazeModel::third}) {
    if (forced ? model != *forced : !bears(model, stations.size())) continue;
    if (forced && stations.size() < termsOf(model)) {
      refuse("too few targets for " + std::string(nameOf(model)) + ": " +
             std::to_string(stations.size()) + " of " + std::to_string(termsOf(model)));
    }
    for (double shrinkage : kShrinkage) {
      if (model < GazeModel::second && shrinkage != kShrinkage[0]) continue;
      StationSystem system{.model = model, .shrinkage = shrinkage};
      const auto terms = static_cast<Eigen::Index>(termsOf(model));
      system.design.resize(n, terms);
      system.goal.resize(n, 2);
      system.metric.resize(n, 2);
      system.weight.resize(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Station& s = stations[static_cast<std::size_t>(i)];
        const auto values = gazeTerms((s.gaze - map.centre) / map.scale);
        for (Eigen::Index t = 0; t < terms; ++t)
          system.design(i, t) = values[static_cast<std::size_t>(t)];
        const glm::dvec2 goal = model == GazeModel::offset ? s.target - s.gaze : s.target;
        for (int axis = 0; axis < 2; ++axis) {
          system.goal(i, axis) = goal[axis];
          system.metric(i, axis) = s.deg_per_unit[axis];
        }
        system.weight[i] = s.weight;
      }
      StationSolution solution = fitStations(system);
      candidates.push_back({std::move(system), std::move(solution), 0.0});
    }
  }
  if (candidates.empty()) refuse("too few targets");

  // Choose by held-out error, bounded so that a slipped target has no vote, and corrected for
  // leverage: E |r / (1 - h)|^2 is noise / (1 - h), a new point in the same place has noise (1 +
  // h).
  double usual = 1e300;
  for (const Candidate& c : candidates) {
    std::vector<double> errors;
    for (Eigen::Index i = 0; i < n; ++i) errors.push_back(heldOut_deg(c.solution, i));
    usual = std::min(usual, quantile(errors, 0.5));
  }
  const double bound = kBounded * std::max(usual, kNoiseFloor_deg);
  const Candidate* best = nullptr;
  for (Candidate& c : candidates) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const double h = c.solution.leverage[i];
      const double error = heldOut_deg(c.solution, i);
      c.score += std::min(error * error * (1.0 - h * h), bound * bound) / static_cast<double>(n);
    }
    auto& of_model = fit.cross_validated_deg[static_cast<std::size_t>(c.system.model)];
    of_model = std::min(of_model.value_or(1e300), std::sqrt(c.score));
    const double gain = best && best->system.model != c.system.model
                            ? kGain[static_cast<std::size_t>(c.system.model)]
                            : 1.0;
    if (!best || c.score < gain * best->score) best = &c;
  }
  const StationSolution& solution = best->solution;

  const glm::dvec2 span = extents(stations, &Station::target);
  std::vector<double> misses;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Station& s = stations[static_cast<std::size_t>(i)];
    misses.push_back(heldOut_deg(solution, i) / glm::length(span * s.deg_per_unit));
    if (solution.weight[i] <= 0.0) fit.refused.push_back(s.target);
  }
  if (quantile(misses, 0.5) > kUnexplained || 2 * fit.refused.size() > stations.size()) {
    refuse("contradictory: gaze does not follow the targets");
  }

  // Keep the model, drawn towards the affine map by as much as that predicts: their mean errs less
  // than either while both predict about alike.
  map.model = best->system.model;
  const std::size_t terms = termsOf(map.model);
  Eigen::MatrixXd coefficients = solution.coefficients;
  for (const Candidate& c : candidates) {
    if (c.system.model != GazeModel::affine || map.model <= GazeModel::affine) continue;
    const double ratio = best->score / std::max(c.score, kNoiseFloor_deg * kNoiseFloor_deg);
    const double share = 1.0 / (1.0 + std::pow(ratio, -kTrust));
    coefficients *= 1.0 - share;
    coefficients.topRows(3) += share * c.solution.coefficients;
  }
  for (std::size_t t = 0; t < terms; ++t) {
    const auto row = static_cast<Eigen::Index>(t);
    map.coefficients[t] = {coefficients(row, 0), coefficients(row, 1)};
    for (std::size_t j = 0; j < terms; ++j) {
      map.covariance_deg2.push_back(solution.covariance(row, static_cast<Eigen::Index>(j)));
    }
  }
  if (map.model == GazeModel::offset) {
    map.coefficients[0] += map.centre;
    map.coefficients[1] = {map.scale.x, 0.0};
    map.coefficients[2] = {0.0, map.scale.y};
  }
  map.low = glm::dvec2(1e300);
  map.high = glm::dvec2(-1e300);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (solution.weight[i] <= 0.0) continue;
    const glm::dvec2 u = (stations[static_cast<std::size_t>(i)].gaze - map.centre) / map.scale;
    map.low = glm::min(map.low, u);
    map.high = glm::max(map.high, u);
  }
  map.target_sd_deg = solution.sd_deg;

  // Scatter of single samples.
  const glm::dvec2 slope =
      glm::abs(glm::dvec2(map.coefficients[1].x, map.coefficients[2].y)) / map.scale;
  double variance = 0.0;
  for (const Station& s : stations) {
    const glm::dvec2 sd = s.gaze_sd * slope * s.deg_per_unit;
    variance += 0.5 * glm::dot(sd, sd) / static_cast<double>(stations.size());
  }
  map.sample_sd_deg = std::sqrt(variance);
  map.sigma_radius = sigmaRadius(solution, stations, slope, variance);
  fit.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace foci
