#include "calibration/solve.h"

#include <glog/logging.h>

#include "base/input_error.h"

namespace foci {
namespace {

/// Ceres also reports a failure through glog, in many lines. The exception below says it in one.
bool silenceLog() {
  FLAGS_minloglevel = google::GLOG_FATAL;
  return true;
}

}  // namespace

void solve(ceres::Solver::Options options, ceres::Problem& problem, const std::string& where) {
  [[maybe_unused]] static const bool silent = silenceLog();
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.IsSolutionUsable()) return;
  const std::string reason = summary.message.substr(0, summary.message.find('\n'));
  throw InputError(where, "no parameters fit the samples (" + reason + ")");
}

std::vector<double> variancesOf(ceres::Problem& problem, const double* block) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.min_reciprocal_condition_number = 1e-60;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  const auto count = static_cast<std::size_t>(problem.ParameterBlockSize(block));
  std::vector<double> all(count * count), variances;
  const std::vector<std::pair<const double*, const double*>> wanted{{block, block}};
  if (!covariance.Compute(wanted, &problem) ||
      !covariance.GetCovarianceBlock(block, block, all.data())) {
    return {};
  }
  for (std::size_t i = 0; i < count; ++i) variances.push_back(all[i * (count + 1)]);
  return variances;
}

}  // namespace foci
