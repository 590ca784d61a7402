#include "calibration/gaze_map/fit_gaze_map.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "base/quantile.h"
#include "calibration/gaze_map/stations.h"

namespace foci {
namespace {

// The constants below were chosen by hand on the simulated users of fit_gaze_map_test.cpp, which
// bound them.
constexpr double kUnexplained = 0.4;  // median held-out error over the extent of the targets
constexpr double kBounded = 3.0;      // a held-out error counts up to this multiple of the median
/// By order: a higher order must lower the held-out error variance to this share of the lower's.
constexpr std::array<double, 4> kGain{1.0, 0.95, 0.8, 0.8};
/// Two fits share the coefficients by the ratio of their error variances to this power.
constexpr double kTrust = 2.0;
/// Prior precision of the powers above the affine, over the noise's.
constexpr std::array<double, 3> kShrinkage{0.03, 0.3, 3.0};
constexpr double kStray = 4.0;  // gaze farther from the median than this multiple of the usual
constexpr std::array<std::size_t, 4> kMinStations{1, 4, 8, 13};  // by order, one or more to spare
constexpr double kOneSigma = 0.6827;  // share of Gaussian errors within one deviation

/// Error that a station would have had if the fit had left it out: r / (1 - h), h its leverage.
double heldOut_deg(const StationSolution& solution, Eigen::Index i) {
  return solution.residual.row(i).norm() / (1.0 - solution.leverage[i]);
}

/// One model fitted with one shrinkage.
struct Candidate {
  StationSystem system;
  StationSolution solution;
  double score = 0.0;  // mean squared held-out error, deg^2
};

/// Centre and scale of gaze such that the targets lie at about |u| <= 1, whatever single targets
/// stray.
void normalise(std::span<const Station> stations, GazeMap& map) {
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> values(stations.size());
    for (std::size_t i = 0; i < stations.size(); ++i) values[i] = stations[i].gaze[axis];
    map.centre[axis] = quantile(values, 0.5);
    for (double& value : values) value = std::abs(value - map.centre[axis]);
    const double usual = quantile(values, 0.5);
    double largest = usual;
    for (double v : values) {
      if (v <= kStray * usual) largest = std::max(largest, v);
    }
    map.scale[axis] = largest > 0.0 ? largest : *std::ranges::max_element(values);
    if (map.scale[axis] <= 0.0) refuseGazeCalibration("gaze does not move along one axis");
  }
}

StationSystem systemOf(std::span<const Station> stations, const GazeMap& map, GazeModel model,
                       double shrinkage) {
  const auto n = static_cast<Eigen::Index>(stations.size());
  const auto terms = static_cast<Eigen::Index>(termsOf(model));
  StationSystem system{.model = model, .shrinkage = shrinkage};
  system.design.resize(n, terms);
  system.goal.resize(n, 2);
  system.metric.resize(n, 2);
  system.weight.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Station& s = stations[static_cast<std::size_t>(i)];
    const auto values = gazeTerms((s.gaze - map.centre) / map.scale);
    for (Eigen::Index t = 0; t < terms; ++t) {
      system.design(i, t) = values[static_cast<std::size_t>(t)];
    }
    const glm::dvec2 goal = model == GazeModel::offset ? s.target - s.gaze : s.target;
    for (int axis = 0; axis < 2; ++axis) {
      system.goal(i, axis) = goal[axis];
      system.metric(i, axis) = s.deg_per_unit[axis];
    }
    system.weight[i] = s.weight;
  }
  return system;
}

/// Fits every model that the number of targets allows, or the forced one; the models above the
/// affine with each shrinkage.
std::vector<Candidate> fitCandidates(std::span<const Station> stations, const GazeMap& map,
                                     std::optional<GazeModel> forced) {
  std::vector<Candidate> candidates;
  for (GazeModel model :
       {GazeModel::offset, GazeModel::affine, GazeModel::second, GazeModel::third}) {
    const bool enough = stations.size() >= kMinStations[static_cast<std::size_t>(model)];
    if (forced ? model != *forced : !enough) continue;
    if (forced && stations.size() < termsOf(model)) {
      refuseGazeCalibration("too few targets for " + std::string(nameOf(model)) + ": " +
                            std::to_string(stations.size()) + " of " +
                            std::to_string(termsOf(model)));
    }
    for (double shrinkage : kShrinkage) {
      if (model < GazeModel::second && shrinkage != kShrinkage[0]) continue;
      StationSystem system = systemOf(stations, map, model, shrinkage);
      StationSolution solution = fitStations(system);
      candidates.push_back({std::move(system), std::move(solution), 0.0});
    }
  }
  if (candidates.empty()) refuseGazeCalibration("too few targets");
  return candidates;
}

/// Scores each candidate by its held-out error and returns the best: of two models, the higher
/// order only if it gains enough (kGain).
const Candidate& chooseCandidate(std::vector<Candidate>& candidates, GazeFit& fit) {
  // A slipped target has no vote: its error is bounded by the best candidate's median.
  const Eigen::Index n = candidates[0].system.design.rows();
  double usual = 1e300;
  for (const Candidate& c : candidates) {
    std::vector<double> errors;
    for (Eigen::Index i = 0; i < n; ++i) errors.push_back(heldOut_deg(c.solution, i));
    usual = std::min(usual, quantile(errors, 0.5));
  }
  const double bound = kBounded * std::max(usual, kNoiseFloor_deg);

  const Candidate* best = nullptr;
  for (Candidate& c : candidates) {
    // Correct for leverage: E |r / (1 - h)|^2 is noise / (1 - h), while a new point in the same
    // place has noise (1 + h).
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
  return *best;
}

/// Lists the targets that the fit gave no weight, and refuses a map that explains too little.
void refuseContradictions(std::span<const Station> stations, const StationSolution& solution,
                          GazeFit& fit) {
  const glm::dvec2 span = extents(stations, &Station::target);
  std::vector<double> misses;
  std::size_t unweighted = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Station& s = stations[i];
    misses.push_back(heldOut_deg(solution, row) / glm::length(span * s.deg_per_unit));
    if (solution.weight[row] > 0.0) continue;
    fit.refused.push_back(s.target);
    ++unweighted;
  }
  if (quantile(misses, 0.5) > kUnexplained || 2 * unweighted > stations.size()) {
    refuseGazeCalibration("contradictory: gaze does not follow the targets");
  }
}

/// Coefficients and their covariance. A curved map is averaged with the affine one, weighted by how
/// well each predicts: the mean errs less than either while both predict about alike.
void takeCoefficients(const Candidate& best, std::span<const Candidate> candidates, GazeMap& map) {
  map.model = best.system.model;
  const std::size_t terms = termsOf(map.model);
  Eigen::MatrixXd coefficients = best.solution.coefficients;
  for (const Candidate& c : candidates) {
    if (c.system.model != GazeModel::affine || map.model <= GazeModel::affine) continue;
    const double ratio = best.score / std::max(c.score, kNoiseFloor_deg * kNoiseFloor_deg);
    const double share = 1.0 / (1.0 + std::pow(ratio, -kTrust));
    coefficients *= 1.0 - share;
    coefficients.topRows(3) += share * c.solution.coefficients;
  }
  for (std::size_t t = 0; t < terms; ++t) {
    const auto row = static_cast<Eigen::Index>(t);
    map.coefficients[t] = {coefficients(row, 0), coefficients(row, 1)};
    for (std::size_t j = 0; j < terms; ++j) {
      map.covariance_deg2.push_back(best.solution.covariance(row, static_cast<Eigen::Index>(j)));
    }
  }
  if (map.model == GazeModel::offset) {
    map.coefficients[0] += map.centre;
    map.coefficients[1] = {map.scale.x, 0.0};
    map.coefficients[2] = {0.0, map.scale.y};
  }
}

/// Range of u over the targets that the fit kept.
void takeRange(std::span<const Station> stations, const StationSolution& solution, GazeMap& map) {
  map.low = glm::dvec2(1e300);
  map.high = glm::dvec2(-1e300);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (solution.weight[static_cast<Eigen::Index>(i)] <= 0.0) continue;
    const glm::dvec2 u = (stations[i].gaze - map.centre) / map.scale;
    map.low = glm::min(map.low, u);
    map.high = glm::max(map.high, u);
  }
}

/// Radius, in deviations per axis, with 68.27 % of the held-out errors of single samples. A few
/// targets determine it poorly, so the Gaussian's own radius counts as kPriorTargets more targets.
double sigmaRadius(const StationSolution& solution, std::span<const Station> stations,
                   const glm::dvec2& slope, double sample_variance) {
  // Two axes and a deviation estimated with nu degrees: r^2 / (2 sd^2) is F(2, nu).
  const double nu = std::max(2.0 * solution.freedom, 1.0);
  const double gaussian = std::sqrt(nu * (std::pow(1.0 - kOneSigma, -2.0 / nu) - 1.0));
  constexpr double kPriorTargets = 9.0;    // as many as the usual calibration has
  constexpr std::size_t kMaxSamples = 64;  // of a target; more change the quantile little
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
  const double found = quantile(ratios, kOneSigma);
  return (found * targets + gaussian * kPriorTargets) / (targets + kPriorTargets);
}

/// How far the observer misses targets, how far single samples scatter, and the radius that holds
/// 68.27 % of both.
void takeUncertainty(std::span<const Station> stations, const StationSolution& solution,
                     GazeMap& map) {
  map.target_sd_deg = solution.sd_deg;
  const glm::dvec2 slope =
      glm::abs(glm::dvec2(map.coefficients[1].x, map.coefficients[2].y)) / map.scale;
  double variance = 0.0;
  for (const Station& s : stations) {
    const glm::dvec2 sd = s.gaze_sd * slope * s.deg_per_unit;
    variance += 0.5 * glm::dot(sd, sd) / static_cast<double>(stations.size());
  }
  map.sample_sd_deg = std::sqrt(variance);
  map.sigma_radius = sigmaRadius(solution, stations, slope, variance);
}

}  // namespace

GazeFit fitGazeMap(std::span<const GazePair> pairs, const GazeFrame& frame,
                   std::optional<GazeModel> forced) {
  const auto begin = std::chrono::steady_clock::now();

  // Reduce the samples of each target to one robust point.
  GazeFit fit;
  std::vector<Station> stations = stationsOf(pairs, frame);
  fit.refused = dropBadTargets(stations);
  refuseUnusable(stations);

  // Fit every model that the targets allow, and choose one by cross-validation.
  fit.map.frame = frame;
  normalise(stations, fit.map);
  std::vector<Candidate> candidates = fitCandidates(stations, fit.map, forced);
  const Candidate& best = chooseCandidate(candidates, fit);
  refuseContradictions(stations, best.solution, fit);

  // Turn the solution into a map that states its own uncertainty.
  takeCoefficients(best, candidates, fit.map);
  takeRange(stations, best.solution, fit.map);
  takeUncertainty(stations, best.solution, fit.map);
  fit.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

std::vector<GazePair> keptPairs(std::span<const GazePair> pairs, const GazeFit& fit) {
  std::vector<GazePair> kept;
  std::ranges::copy_if(pairs, std::back_inserter(kept), [&](const GazePair& pair) {
    return std::ranges::find(fit.refused, pair.target) == fit.refused.end();
  });
  return kept;
}

}  // namespace foci
