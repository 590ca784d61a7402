#include "calibration/fit_gaze_map.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "app/base/input_error.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr std::size_t kFewestTargets = 3;
constexpr double kCollinear = 0.02;   // smaller over larger extent of the targets or of the gaze
constexpr double kScattered = 0.35;   // deviation at one target over the extent of the gaze
constexpr double kUnexplained = 0.6;  // residual over the extent of the targets
constexpr double kNoiseFloor_deg = 0.005;  // no tracker is better; keeps exact data solvable
constexpr double kOutlierChance = 1e-3;    // of a target refused that belongs, over all targets
constexpr double kFewestFreedoms = 4.0;    // that must be left to call a target slipped
constexpr double kTukey = 4.685;
constexpr double kBounded = 3.0;  // a held-out error counts up to so many times the median
constexpr std::array<double, 4> kGain{
    1.0, 0.95, 0.8, 0.8};  // error variance that one more order must leave at most
constexpr std::array<double, 3> kShrinkage{0.03, 0.3,
                                           3.0};  // prior precision of powers, over the noise's

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
  if (stations.empty()) refuse("no sample with gaze at any target");
  // Samples of one target share the observer's error there: more of them hardly make it surer.
  const double usual = quantile(totals, 0.5);
  for (Station& s : stations) s.weight = std::clamp(s.weight / usual, 0.1, 1.0);
  return stations;
}

void refuseHopeless(std::span<const Station> stations) {
  if (stations.size() < kFewestTargets) {
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

/// One model's linear system: design * coefficients = goal, in degrees along each axis.
struct System {
  GazeModel model = GazeModel::offset;
  double shrinkage = 0.0;
  Eigen::MatrixXd design{};  // stations x terms
  Eigen::MatrixXd goal{};    // stations x 2, units
  Eigen::MatrixXd metric{};  // stations x 2, degrees per unit
  Eigen::VectorXd weight{};

  double prior(Eigen::Index term) const { return term > 2 ? shrinkage : 0.0; }
};

struct Solution {
  Eigen::MatrixXd coefficients;  // terms x 2, units
  Eigen::MatrixXd covariance;    // terms x terms, deg^2
  Eigen::VectorXd weight;        // the loss's, 0 to 1
  Eigen::VectorXd leverage;
  Eigen::MatrixXd residual;  // stations x 2, deg
  double sd_deg = 0.0;       // per axis
  double freedom = 0.0;      // stations less effective terms
  Eigen::MatrixXd inverse;   // of the normal matrix
};

/// Weighted ridge regression in closed form, one isotropic metric a station so that both axes share
/// it.
Solution solveLinear(const System& system, const Eigen::VectorXd& weight) {
  const Eigen::Index n = system.design.rows(), k = system.design.cols();
  const Eigen::VectorXd w = weight.cwiseProduct(system.weight);
  Eigen::MatrixXd normal = system.design.transpose() * w.asDiagonal() * system.design;
  for (Eigen::Index t = 0; t < k; ++t) normal(t, t) += system.prior(t) + 1e-12;
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
  Solution solution;
  solution.coefficients = factor.solve(system.design.transpose() * w.asDiagonal() * system.goal);
  solution.weight = weight;
  solution.residual =
      (system.goal - system.design * solution.coefficients).cwiseProduct(system.metric);
  solution.inverse = factor.solve(Eigen::MatrixXd::Identity(k, k));
  const Eigen::MatrixXd spread = solution.inverse * system.design.transpose();
  solution.leverage.resize(n);
  double square = 0.0, count = 0.0, used = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    solution.leverage[i] = std::min(w[i] * system.design.row(i).dot(spread.col(i)), 0.999);
    square += w[i] * solution.residual.row(i).squaredNorm();
    count += weight[i];
    used += solution.leverage[i];
  }
  solution.freedom = count - used;
  solution.sd_deg =
      std::hypot(std::sqrt(square / (2.0 * std::max(solution.freedom, 0.5))), kNoiseFloor_deg);
  return solution;
}

/// Chance that noise alone lets the residual sum of squares fall to the share `rest` of what it was
/// when `removed` stations go: I_rest(nu / 2, removed), the F test of a mean shift (Cook and
/// Weisberg 1982).
double chanceOfDrop(double rest, double nu, std::size_t removed) {
  double term = 1.0, sum = 1.0;
  for (std::size_t j = 1; j < removed; ++j) {
    term *= (0.5 * nu + static_cast<double>(j - 1)) / static_cast<double>(j) * (1.0 - rest);
    sum += term;
  }
  return std::pow(rest, 0.5 * nu) * sum;
}

/// Calls `visit` with each way to choose `size` of `n`, in order.
template <typename Visit>
void forSubsets(std::size_t n, std::size_t size, Visit visit) {
  std::vector<std::size_t> chosen(size);
  for (std::size_t i = 0; i < size; ++i) chosen[i] = i;
  while (size <= n) {
    visit(chosen);
    std::size_t last = size;
    while (last > 0 && chosen[last - 1] == n - size + last - 1) --last;
    if (last == 0) return;
    ++chosen[last - 1];
    for (std::size_t i = last; i < size; ++i) chosen[i] = chosen[i - 1] + 1;
  }
}

/// Leaves out the targets that nobody looked at: those, up to three at once so that they cannot
/// mask each other, whose removal lowers the residual by more than chance would. At most a third of
/// all.
Solution withoutSlips(const System& system) {
  const auto n = static_cast<std::size_t>(system.design.rows());
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(system.design.rows());
  Solution solution = solveLinear(system, weight);
  const std::size_t most = std::min<std::size_t>(n / 3, 64);
  for (std::size_t removed = 0; removed < most;) {
    // Residuals scaled by their weights, and the hat matrix among the stations still in.
    std::vector<Eigen::Index> in;
    for (Eigen::Index i = 0; i < weight.size(); ++i) {
      if (weight[i] > 0.0) in.push_back(i);
    }
    const auto m = static_cast<Eigen::Index>(in.size());
    Eigen::MatrixXd residual(m, 2), design(m, system.design.cols());
    for (Eigen::Index i = 0; i < m; ++i) {
      const double root = std::sqrt(system.weight[in[i]]);
      residual.row(i) = root * solution.residual.row(in[i]);
      design.row(i) = root * system.design.row(in[i]);
    }
    const double total = residual.squaredNorm();
    const Eigen::MatrixXd spread = solution.inverse * design.transpose();

    double least_chance = kOutlierChance;
    std::vector<std::size_t> worst;
    const std::size_t together = m <= 16 ? 3 : m <= 40 ? 2 : 1;
    double ways = 1.0;
    for (std::size_t size = 1; size <= std::min(together, most - removed); ++size) {
      ways *= static_cast<double>(in.size() - size + 1) / static_cast<double>(size);
      const double nu = 2.0 * (solution.freedom - static_cast<double>(size));
      if (nu < kFewestFreedoms) break;
      forSubsets(in.size(), size, [&](const std::vector<std::size_t>& chosen) {
        Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
        Eigen::Matrix<double, 3, 2> missed = Eigen::Matrix<double, 3, 2>::Zero();
        for (std::size_t i = 0; i < size; ++i) {
          const auto a = static_cast<Eigen::Index>(chosen[i]), row = static_cast<Eigen::Index>(i);
          missed.row(row) = residual.row(a);
          for (std::size_t j = 0; j < size; ++j) {
            const auto b = static_cast<Eigen::Index>(chosen[j]);
            left(row, static_cast<Eigen::Index>(j)) -= design.row(a).dot(spread.col(b));
          }
        }
        if (left.determinant() < 1e-6) return;  // the rest would no longer bear the model
        const double drop = (missed.transpose() * left.inverse() * missed).trace();
        const double floor = nu * kNoiseFloor_deg * kNoiseFloor_deg;
        const double rest = std::min((std::max(total - drop, 0.0) + floor) / (total + floor), 1.0);
        const double chance = ways * chanceOfDrop(rest, nu, size);
        if (chance < least_chance) {
          least_chance = chance;
          worst = chosen;
        }
      });
    }
    if (worst.empty()) break;
    for (std::size_t i : worst) weight[in[i]] = 0.0;
    removed += worst.size();
    solution = solveLinear(system, weight);
  }
  return solution;
}

/// One station: both axes under one loss, in units of the noise. Parameters: x and y of each term.
class StationCost final : public ceres::CostFunction {
 public:
  StationCost(const System& system, Eigen::Index row, double sd_deg)
      : system_(system), row_(row), factor_(std::sqrt(system.weight[row]) / sd_deg) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(2 * system.design.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Index k = system_.design.cols();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double scale = factor_ * system_.metric(row_, axis);
      double sum = -system_.goal(row_, axis);
      for (Eigen::Index t = 0; t < k; ++t) {
        sum += system_.design(row_, t) * parameters[0][2 * t + axis];
      }
      residuals[axis] = scale * sum;
      if (!jacobians || !jacobians[0]) continue;
      double* row = jacobians[0] + axis * 2 * k;
      std::fill(row, row + 2 * k, 0.0);
      for (Eigen::Index t = 0; t < k; ++t) row[2 * t + axis] = scale * system_.design(row_, t);
    }
    return true;
  }

 private:
  const System& system_;
  Eigen::Index row_;
  double factor_;
};

/// The prior that keeps a power near 0.
class ShrinkCost final : public ceres::CostFunction {
 public:
  ShrinkCost(const System& system, Eigen::Index term, double sd_deg)
      : terms_(system.design.cols()),
        term_(term),
        factor_(std::sqrt(system.prior(term)) / sd_deg),
        metric_(system.metric.colwise().mean()) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(2 * terms_));
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    if (jacobians && jacobians[0]) std::fill(jacobians[0], jacobians[0] + 4 * terms_, 0.0);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double scale = factor_ * metric_[axis];
      residuals[axis] = scale * parameters[0][2 * term_ + axis];
      if (jacobians && jacobians[0]) jacobians[0][axis * 2 * terms_ + 2 * term_ + axis] = scale;
    }
    return true;
  }

 private:
  Eigen::Index terms_, term_;
  double factor_;
  Eigen::RowVector2d metric_;
};

/// The robust fit, from the best start that `withoutSlips` finds.
Solution solveRobust(const System& system) {
  const Eigen::Index n = system.design.rows(), k = system.design.cols();
  const Solution start = withoutSlips(system);
  const double sd_deg = start.sd_deg;

  std::vector<double> parameters(static_cast<std::size_t>(2 * k));
  for (Eigen::Index t = 0; t < k; ++t) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      parameters[static_cast<std::size_t>(2 * t + axis)] = start.coefficients(t, axis);
    }
  }
  ceres::Problem problem;
  for (Eigen::Index i = 0; i < n; ++i) {
    problem.AddResidualBlock(new StationCost(system, i, sd_deg), new ceres::TukeyLoss(kTukey),
                             parameters.data());
  }
  for (Eigen::Index t = 0; t < k; ++t) {
    if (system.prior(t) > 0.0) {
      problem.AddResidualBlock(new ShrinkCost(system, t, sd_deg), nullptr, parameters.data());
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  // What the loss left of each station decides covariance and cross-validation.
  Eigen::MatrixXd coefficients(k, 2);
  for (Eigen::Index t = 0; t < k; ++t) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      coefficients(t, axis) = parameters[static_cast<std::size_t>(2 * t + axis)];
    }
  }
  const Eigen::MatrixXd residual =
      (system.goal - system.design * coefficients).cwiseProduct(system.metric);
  Eigen::VectorXd weight(n);
  const ceres::TukeyLoss loss(kTukey);
  for (Eigen::Index i = 0; i < n; ++i) {
    double rho[3];
    loss.Evaluate(system.weight[i] * residual.row(i).squaredNorm() / (sd_deg * sd_deg), rho);
    weight[i] = rho[1];
  }
  Solution solution = solveLinear(system, weight);
  solution.coefficients = coefficients;
  solution.residual = residual;
  solution.sd_deg = sd_deg;

  ceres::Covariance::Options covariance_options;
  covariance_options.algorithm_type = ceres::DENSE_SVD;
  covariance_options.null_space_rank = -1;
  ceres::Covariance covariance(covariance_options);
  solution.covariance = Eigen::MatrixXd::Zero(k, k);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> both(2 * k, 2 * k);
  const double* block = parameters.data();
  if (covariance.Compute(std::vector<std::pair<const double*, const double*>>{{block, block}},
                         &problem) &&
      covariance.GetCovarianceBlock(block, block, both.data())) {
    const Eigen::RowVector2d mean = system.metric.colwise().mean();
    for (Eigen::Index i = 0; i < k; ++i) {
      for (Eigen::Index j = 0; j < k; ++j) {
        solution.covariance(i, j) = 0.5 * (both(2 * i, 2 * j) * mean[0] * mean[0] +
                                           both(2 * i + 1, 2 * j + 1) * mean[1] * mean[1]);
      }
    }
  }
  return solution;
}

/// Error that a station would have had, had it not been fitted: r / (1 - h).
double heldOut_deg(const Solution& solution, Eigen::Index i) {
  return solution.residual.row(i).norm() / (1.0 - solution.leverage[i]);
}

struct Candidate {
  System system;
  Solution solution;
  double score = 0.0;  // deg^2
};

bool bears(GazeModel model, std::size_t stations) {
  constexpr std::array<std::size_t, 4> kFewest{1, 4, 8, 13};
  return stations >= kFewest[static_cast<std::size_t>(model)];
}

/// Radius, in deviations per axis, with 68.27 % of the held-out errors of single samples. Few
/// targets say little of it: the Gaussian's own radius counts as so many targets more.
double sigmaRadius(const Solution& solution, std::span<const Station> stations,
                   const glm::dvec2& slope, double sample_variance) {
  // Two axes and a deviation estimated with nu degrees: r^2 / (2 sd^2) is F(2, nu).
  const double nu = std::max(2.0 * solution.freedom, 1.0);
  const double gaussian = std::sqrt(nu * (std::pow(1.0 - 0.6827, -2.0 / nu) - 1.0));
  constexpr double kPriorTargets = 9.0;
  constexpr std::size_t kMostSamples = 64;
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
    const std::size_t step = s.samples.size() / kMostSamples + 1;
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
    std::vector<double> values;
    for (const Station& s : stations) values.push_back(s.gaze[axis]);
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
      System system{.model = model, .shrinkage = shrinkage};
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
      Solution solution = solveRobust(system);
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
  const Solution& solution = best->solution;

  const glm::dvec2 span = extents(stations, &Station::target);
  std::vector<double> misses;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Station& s = stations[static_cast<std::size_t>(i)];
    misses.push_back(solution.residual.row(i).norm() / glm::length(span * s.deg_per_unit));
    if (solution.weight[i] <= 0.0) fit.refused.push_back(s.target);
  }
  if (quantile(misses, 0.5) > kUnexplained * 0.5 || 2 * fit.refused.size() > stations.size()) {
    refuse("contradictory: gaze does not follow the targets");
  }

  // Keep the model and what it says of its own errors.
  map.model = best->system.model;
  const std::size_t terms = termsOf(map.model);
  for (std::size_t t = 0; t < terms; ++t) {
    const auto row = static_cast<Eigen::Index>(t);
    map.coefficients[t] = {solution.coefficients(row, 0), solution.coefficients(row, 1)};
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
