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

}  // namespace foci
