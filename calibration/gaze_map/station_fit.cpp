#include "calibration/gaze_map/station_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

constexpr double kOutlierChance = 1e-3;  // of a target refused that belongs, over all targets
constexpr double kMinFreedoms = 4.0;     // that must be left to call a target slipped
constexpr double kTukey = 4.685;

/// Weighted ridge regression in closed form, one isotropic metric a station so that both axes share
/// it.
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
StationSolution withoutSlips(const StationSystem& system) {
  const auto n = static_cast<std::size_t>(system.design.rows());
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(system.design.rows());
  StationSolution solution = solveLinear(system, weight);
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

    double min_chance = kOutlierChance;
    std::vector<std::size_t> worst;
    const std::size_t together = m <= 16 ? 3 : m <= 40 ? 2 : 1;
    double ways = 1.0;
    for (std::size_t size = 1; size <= std::min(together, most - removed); ++size) {
      ways *= static_cast<double>(in.size() - size + 1) / static_cast<double>(size);
      const double nu = 2.0 * (solution.freedom - static_cast<double>(size));
      if (nu < kMinFreedoms) break;
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
        if (chance < min_chance) {
          min_chance = chance;
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
  StationCost(const StationSystem& system, Eigen::Index row, double sd_deg)
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
  const StationSystem& system_;
  Eigen::Index row_;
  double factor_;
};

/// The prior that keeps a power near 0.
class ShrinkCost final : public ceres::CostFunction {
 public:
  ShrinkCost(const StationSystem& system, Eigen::Index term, double sd_deg)
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

}  // namespace

StationSolution fitStations(const StationSystem& system) {
  const Eigen::Index n = system.design.rows(), k = system.design.cols();
  const StationSolution start = withoutSlips(system);
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
  StationSolution solution = solveLinear(system, weight);
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

}  // namespace foci
