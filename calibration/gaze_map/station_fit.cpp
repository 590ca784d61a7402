#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/quantile.h"
#include "calibration/gaze_map/stations.h"
#include "calibration/solve.h"

namespace foci {
namespace {

constexpr double kOutlierChance = 1e-3;  // of calling any good target slipped, over all subsets
constexpr double kMinFreedoms = 4.0;     // residual degrees of freedom needed to judge a target
constexpr std::size_t kMaxSlipped = 64;

/// Weighted ridge regression in closed form. Both axes share the normal matrix.
StationSolution solveLinear(const StationSystem& system, const Eigen::VectorXd& weight) {
  const Eigen::Index n = system.design.rows(), k = system.design.cols();
  const Eigen::VectorXd w = weight.cwiseProduct(system.weight);
  Eigen::MatrixXd normal = system.design.transpose() * w.asDiagonal() * system.design;
  for (Eigen::Index t = 0; t < k; ++t) normal(t, t) += system.prior(t) + 1e-12;
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
  StationSolution solution;
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

/// Probability that noise alone lowers the residual sum of squares to the share `rest` when
/// `removed` stations are left out: I_rest(nu / 2, removed), the F test of a mean shift (Cook and
/// Weisberg 1982).
double chanceOfDrop(double rest, double nu, std::size_t removed) {
  double term = 1.0, sum = 1.0;
  for (std::size_t j = 1; j < removed; ++j) {
    term *= (0.5 * nu + static_cast<double>(j - 1)) / static_cast<double>(j) * (1.0 - rest);
    sum += term;
  }
  return std::pow(rest, 0.5 * nu) * sum;
}

/// Calls `visit` with each subset of `size` out of `n` indices, in lexicographic order.
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

/// The stations still in the fit, scaled by the roots of their weights.
struct Remaining {
  std::vector<Eigen::Index> rows;  // of the system
  Eigen::MatrixXd residual, design, spread;
};

Remaining remainingOf(const StationSystem& system, const StationSolution& solution) {
  Remaining in;
  for (Eigen::Index i = 0; i < solution.weight.size(); ++i) {
    if (solution.weight[i] > 0.0) in.rows.push_back(i);
  }
  const auto m = static_cast<Eigen::Index>(in.rows.size());
  in.residual.resize(m, 2);
  in.design.resize(m, system.design.cols());
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index row = in.rows[static_cast<std::size_t>(i)];
    const double root = std::sqrt(system.weight[row]);
    in.residual.row(i) = root * solution.residual.row(row);
    in.design.row(i) = root * system.design.row(row);
  }
  in.spread = solution.inverse * in.design.transpose();
  return in;
}

/// How far the residual sum of squares falls when the `chosen` stations (at most 3) are left out:
/// e' (I - H)^-1 e over the chosen rows, H the hat matrix. Absent where the other stations no
/// longer determine the model.
std::optional<double> dropWithout(const Remaining& in, const std::vector<std::size_t>& chosen) {
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 2> missed = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto a = static_cast<Eigen::Index>(chosen[i]), row = static_cast<Eigen::Index>(i);
    missed.row(row) = in.residual.row(a);
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      const auto b = static_cast<Eigen::Index>(chosen[j]);
      left(row, static_cast<Eigen::Index>(j)) -= in.design.row(a).dot(in.spread.col(b));
    }
  }
  if (left.determinant() < 1e-6) return std::nullopt;
  return (missed.transpose() * left.inverse() * missed).trace();
}

/// The subset of at most `max` stations whose misfit is least likely to be noise; empty where noise
/// explains every subset.
std::vector<std::size_t> slippedSubset(const Remaining& in, double freedom, std::size_t max) {
  const double total = in.residual.squaredNorm();
  double min_chance = kOutlierChance;
  std::vector<std::size_t> slipped;
  // At most 780 subsets of one size.
  const std::size_t together = in.rows.size() <= 16 ? 3 : in.rows.size() <= 40 ? 2 : 1;
  double subsets = 1.0;
  for (std::size_t size = 1; size <= std::min(together, max); ++size) {
    subsets *= static_cast<double>(in.rows.size() - size + 1) / static_cast<double>(size);
    const double nu = 2.0 * (freedom - static_cast<double>(size));
    if (nu < kMinFreedoms) break;
    forSubsets(in.rows.size(), size, [&](const std::vector<std::size_t>& chosen) {
      const auto drop = dropWithout(in, chosen);
      if (!drop) return;
      const double floor = nu * kNoiseFloor_deg * kNoiseFloor_deg;
      const double rest = std::min((std::max(total - *drop, 0.0) + floor) / (total + floor), 1.0);
      const double chance = subsets * chanceOfDrop(rest, nu, size);
      if (chance < min_chance) {
        min_chance = chance;
        slipped = chosen;
      }
    });
  }
  return slipped;
}

/// The solution without slipped targets, which the observer did not look at. Subsets are tested
/// together so that slips cannot mask each other. At most a third of all stations are left out.
StationSolution withoutSlips(const StationSystem& system) {
  const auto n = static_cast<std::size_t>(system.design.rows());
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(system.design.rows());
  StationSolution solution = solveLinear(system, weight);
  const std::size_t max_removed = std::min(n / 3, kMaxSlipped);
  for (std::size_t removed = 0; removed < max_removed;) {
    const Remaining in = remainingOf(system, solution);
    const auto slipped = slippedSubset(in, solution.freedom, max_removed - removed);
    if (slipped.empty()) break;
    for (std::size_t i : slipped) weight[in.rows[i]] = 0.0;
    removed += slipped.size();
    solution = solveLinear(system, weight);
  }
  return solution;
}

/// Misses of a row of terms, both axes under one loss: scale (row * coefficients - goal).
/// Parameters: x and y of each term.
class RowCost final : public ceres::CostFunction {
 public:
  RowCost(Eigen::RowVectorXd row, Eigen::RowVector2d goal, Eigen::RowVector2d scale)
      : row_(std::move(row)), goal_(std::move(goal)), scale_(std::move(scale)) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(2 * row_.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Index k = row_.size();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      double sum = -goal_[axis];
      for (Eigen::Index t = 0; t < k; ++t) sum += row_[t] * parameters[0][2 * t + axis];
      residuals[axis] = scale_[axis] * sum;
      if (!jacobians || !jacobians[0]) continue;
      double* row = jacobians[0] + axis * 2 * k;
      std::fill(row, row + 2 * k, 0.0);
      for (Eigen::Index t = 0; t < k; ++t) row[2 * t + axis] = scale_[axis] * row_[t];
    }
    return true;
  }

 private:
  Eigen::RowVectorXd row_;
  Eigen::RowVector2d goal_, scale_;
};

/// Minimises Tukey's loss from `parameters`: x and y of each term.
void minimise(const StationSystem& system, double sd_deg, ceres::Problem& problem,
              std::vector<double>& parameters) {
  for (Eigen::Index i = 0; i < system.design.rows(); ++i) {
    const double factor = std::sqrt(system.weight[i]) / sd_deg;
    problem.AddResidualBlock(
        new RowCost(system.design.row(i), system.goal.row(i), factor * system.metric.row(i)),
        new ceres::TukeyLoss(kTukey), parameters.data());
  }
  // The prior shrinks single powers towards 0.
  for (Eigen::Index t = 0; t < system.design.cols(); ++t) {
    if (system.prior(t) <= 0.0) continue;
    const double factor = std::sqrt(system.prior(t)) / sd_deg;
    problem.AddResidualBlock(
        new RowCost(Eigen::RowVectorXd::Unit(system.design.cols(), t), Eigen::RowVector2d::Zero(),
                    factor * system.metric.colwise().mean()),
        nullptr, parameters.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-10;
  solve(options, problem, "gaze calibration");
}

/// The weight that Tukey's loss leaves each station, 0 to 1.
Eigen::VectorXd weightsOf(const StationSystem& system, const Eigen::MatrixXd& residual,
                          double sd_deg) {
  Eigen::VectorXd weight(residual.rows());
  const ceres::TukeyLoss loss(kTukey);
  for (Eigen::Index i = 0; i < residual.rows(); ++i) {
    double rho[3];
    loss.Evaluate(system.weight[i] * residual.row(i).squaredNorm() / (sd_deg * sd_deg), rho);
    weight[i] = rho[1];
  }
  return weight;
}

/// Covariance of the terms, mean of both axes, deg^2; 0 where Ceres cannot tell it.
Eigen::MatrixXd covarianceOf(const StationSystem& system, ceres::Problem& problem,
                             const std::vector<double>& parameters) {
  const Eigen::Index k = system.design.cols();
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  ceres::Covariance covariance(options);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(k, k);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> both(2 * k, 2 * k);
  const double* block = parameters.data();
  if (covariance.Compute(std::vector<std::pair<const double*, const double*>>{{block, block}},
                         &problem) &&
      covariance.GetCovarianceBlock(block, block, both.data())) {
    const Eigen::RowVector2d mean = system.metric.colwise().mean();
    for (Eigen::Index i = 0; i < k; ++i) {
      for (Eigen::Index j = 0; j < k; ++j) {
        result(i, j) = 0.5 * (both(2 * i, 2 * j) * mean[0] * mean[0] +
                              both(2 * i + 1, 2 * j + 1) * mean[1] * mean[1]);
      }
    }
  }
  return result;
}

}  // namespace

StationSolution fitStations(const StationSystem& system) {
  const Eigen::Index k = system.design.cols();
  const StationSolution start = withoutSlips(system);

  // Minimise from the start that leaves out slipped targets.
  std::vector<double> parameters(static_cast<std::size_t>(2 * k));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>> by_term(parameters.data(),
                                                                                k, 2);
  by_term = start.coefficients;
  ceres::Problem problem;
  minimise(system, start.sd_deg, problem, parameters);
  const Eigen::MatrixXd coefficients = by_term;

  // Leverage and freedom follow from the weights that the loss left.
  const Eigen::MatrixXd residual =
      (system.goal - system.design * coefficients).cwiseProduct(system.metric);
  StationSolution solution = solveLinear(system, weightsOf(system, residual, start.sd_deg));
  solution.coefficients = coefficients;
  solution.residual = residual;
  solution.sd_deg = start.sd_deg;
  solution.covariance = covarianceOf(system, problem, parameters);
  return solution;
}

}  // namespace foci
