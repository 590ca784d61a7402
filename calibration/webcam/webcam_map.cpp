#include "calibration/webcam/webcam_map.h"

#include <ceres/normal_prior.h>
#include <Eigen/Dense>
#include <cmath>

#include "base/input_error.h"
#include "base/quantile.h"
#include "calibration/location.h"
#include "calibration/solve.h"

namespace foci {
namespace {

constexpr const char* kWhere = "webcam calibration";
constexpr std::size_t kTerms = WebcamMap::kTurnTerms;
constexpr std::size_t kAll = WebcamMap::kParameters;
constexpr double kCauchy = 2.0;  // in deviations; 2.385 is 95 % efficient (Holland, Welsch 1977)
constexpr double kStartSd_deg = 2.0;   // webcams: Labvanced 1.4 deg, WebGazer 3.9 deg
constexpr double kMinSd_deg = 0.05;    // an observer fixates no more exactly
constexpr double kMaxAngle_rad = 1.4;  // a line of sight beyond 80 deg meets no screen
constexpr double kMinHead_m = 0.05;
constexpr double kMinTrust = 1e-6;  // keeps the information positive definite
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <typename T>
void pointOf(const T* p, const WebcamView& view, T* point) {
  // Take the head's roll out of the eye's offset.
  const double c = std::cos(view.roll_rad), s = std::sin(view.roll_rad);
  const double x = c * view.eye.x + s * view.eye.y, y = -s * view.eye.x + c * view.eye.y;
  const double terms[kTerms] = {1.0, x, y, x * y, x * x, y * y};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    T angle = p[2 * kTerms + axis] * view.head_rad[static_cast<int>(axis)];
    for (std::size_t k = 0; k < kTerms; ++k) angle += p[axis * kTerms + k] * terms[k];
    if (angle > T(kMaxAngle_rad)) angle = T(kMaxAngle_rad);
    if (angle < T(-kMaxAngle_rad)) angle = T(-kMaxAngle_rad);
    point[axis] =
        view.head_m[static_cast<int>(axis)] + p[2 * kTerms + 2 + axis] + view.head_m.z * tan(angle);
  }
}

/// Distance from the target as an angle at the observer's eye, over the deviation.
struct ScreenError {
  WebcamSample sample;
  double sd_deg;

  template <typename T>
  bool operator()(const T* p, T* residual) const {
    pointOf(p, sample.view, residual);
    const double scale = glm::degrees(1.0) / sample.view.head_m.z / sd_deg;
    for (int axis = 0; axis < 2; ++axis) {
      residual[axis] = (residual[axis] - sample.target_m[axis]) * scale;
    }
    return true;
  }
};

/// Information of the parameters at the solution, J' J, row-major.
std::vector<double> informationOf(ceres::Problem& problem) {
  ceres::CRSMatrix sparse;
  problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse);
  Matrix jacobian = Matrix::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[row]; i < sparse.rows[row + 1]; ++i) {
      jacobian(row, sparse.cols[i]) = sparse.values[i];
    }
  }
  const Matrix normal = jacobian.transpose() * jacobian;
  return {normal.data(), normal.data() + kAll * kAll};
}

}  // namespace

WebcamMap nominalWebcamMap() {
  // Turn of the eye, in radians, that moves the iris by one eye width: width over radius, mm.
  constexpr double kTurnPerWidth = 30.0 / 12.0;
  constexpr double kCameraAbove_m = 0.15;  // half the height of a 24-inch screen
  // Deviations chosen by hand: wide for what differs between faces, 10 % and 10 cm for the rest.
  WebcamMap map;
  map.parameters[1] = kTurnPerWidth;
  map.parameters[kTerms + 2] = kTurnPerWidth;
  map.parameters[2 * kTerms] = map.parameters[2 * kTerms + 1] = 1.0;
  map.parameters[2 * kTerms + 3] = kCameraAbove_m;
  std::array<double, kAll> sd{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double* turn = &sd[axis * kTerms];
    turn[0] = 0.3;
    turn[1] = turn[2] = 1.5;
    turn[3] = turn[4] = turn[5] = 2.0;
    sd[2 * kTerms + axis] = 0.1;
    sd[2 * kTerms + 2 + axis] = 0.1;
  }
  map.information.assign(kAll * kAll, 0.0);
  for (std::size_t i = 0; i < kAll; ++i) map.information[i * kAll + i] = 1.0 / (sd[i] * sd[i]);
  map.sd_deg = kStartSd_deg;
  return map;
}

WebcamMap fitWebcamMap(std::span<const WebcamSample> samples, const WebcamMap& prior,
                       double trust) {
  for (const WebcamSample& s : samples) {
    const WebcamView& v = s.view;
    const double sum = v.eye.x + v.eye.y + v.head_m.x + v.head_m.y + v.head_m.z + v.head_rad.x +
                       v.head_rad.y + v.roll_rad + s.target_m.x + s.target_m.y;
    if (!std::isfinite(sum) || v.head_m.z < kMinHead_m) {
      throw InputError(kWhere, "a view without a head in front of the screen");
    }
  }
  const Matrix information =
      std::max(trust, kMinTrust) * Eigen::Map<const Matrix>(prior.information.data(), kAll, kAll);
  // Misfit to the prior: L (p - centre), with information = L' L.
  const Matrix root = Eigen::LLT<Matrix>(information).matrixU();
  const Eigen::VectorXd centre = Eigen::Map<const Eigen::VectorXd>(prior.parameters.data(), kAll);

  // The loss needs the deviation of the samples, which only a fit tells. Begin wide, so that the
  // samples of a drifted map do not count as outliers.
  WebcamMap map = prior;
  double usual_deg = kStartSd_deg;
  for (int round = 0; round < 3; ++round) {
    ceres::Problem problem;
    for (const WebcamSample& sample : samples) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScreenError, 2, kAll>(
                                   new ScreenError{sample, map.sd_deg}),
                               new ceres::CauchyLoss(kCauchy * usual_deg / map.sd_deg),
                               map.parameters.data());
    }
    problem.AddResidualBlock(new ceres::NormalPrior(root, centre), nullptr, map.parameters.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 100;
    solve(options, problem, kWhere);
    map.information = informationOf(problem);

    if (samples.size() <= kAll) continue;  // too few for a deviation of their own
    std::vector<double> misses;
    for (const WebcamSample& s : samples) {
      misses.push_back(glm::length(pointOnScreen_m(map, s.view) - s.target_m) / s.view.head_m.z);
    }
    map.sd_deg = std::max(glm::degrees(quantile(misses, 0.5)) / kRayleighMedian, kMinSd_deg);
    usual_deg = map.sd_deg;
  }
  return map;
}

glm::dvec2 pointOnScreen_m(const WebcamMap& map, const WebcamView& view) {
  glm::dvec2 point;
  pointOf(map.parameters.data(), view, &point.x);
  return point;
}

}  // namespace foci
