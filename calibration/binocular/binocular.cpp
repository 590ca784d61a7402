#include "calibration/binocular/binocular.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/input_error.h"
#include "base/quantile.h"
#include "calibration/location.h"
#include "gaze/focus/vergence.h"

namespace foci {
namespace {

constexpr std::size_t kMinSamples = 20, kMinBinocularTargets = 3;
constexpr double kCauchy = 2.0;  // in deviations of the residual
constexpr double kKnown_m = 0.02, kKnown_deg = 1.0;
constexpr int kRounds = 3;  // fits, each with the scale that the one before left

/// Difference of yaw and pitch between the corrected direction and the target. Radians.
struct SightError {
  BinocularSample::Eye eye;
  glm::dvec2 target_m;
  double sd_rad;

  template <typename T>
  bool operator()(const T* pose, const T* kappa, T* residual) const {
    const T display[3] = {T(target_m.x), T(target_m.y), T(0.0)};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, display, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i] - T(eye.centre_m[i]);
    const T depth = sqrt(p[0] * p[0] + p[2] * p[2]);
    if (depth < T(1e-6)) return false;
    const glm::dvec3 d = glm::normalize(eye.direction);
    // Yaw shrinks with the cosine of pitch, as angles on a sphere do.
    const double cosine = std::sqrt(std::max(1.0 - d.y * d.y, 0.0));
    const T yaw = T(std::atan2(d.x, d.z)) + kappa[0] - atan2(p[0], p[2]);
    const T pitch = T(std::asin(std::clamp(d.y, -1.0, 1.0))) + kappa[1] - atan2(p[1], depth);
    residual[0] = atan2(sin(yaw), cos(yaw)) * T(cosine / sd_rad);
    residual[1] = pitch / T(sd_rad);
    return true;
  }
};

glm::dmat3 rotationOf(const double* angle_axis) {
  double column_major[9];
  ceres::AngleAxisToRotationMatrix(angle_axis, column_major);
  glm::dmat3 rotation;
  for (int i = 0; i < 9; ++i) rotation[i / 3][i % 3] = column_major[i];
  return rotation;
}

double medianVergenceError_D(std::span<const BinocularSample> samples, const BinocularMap& seen,
                             const BinocularMap& truth) {
  std::vector<double> errors;
  for (const BinocularSample& sample : samples) {
    const auto vergence = vergence_D(seen, sample);
    if (!vergence) continue;
    const glm::dvec3 target =
        truth.rotation * glm::dvec3(sample.target_m, 0.0) + truth.translation_m;
    const glm::dvec3 middle = 0.5 * (sample.eyes[0]->centre_m + sample.eyes[1]->centre_m);
    errors.push_back(*vergence - 1.0 / glm::length(target - middle));
  }
  return errors.empty() ? 0.0 : quantile(errors, 0.5);
}

}  // namespace

glm::dvec3 correctedDirection(const BinocularMap& map, std::size_t eye,
                              const glm::dvec3& direction) {
  const glm::dvec3 d = glm::normalize(direction);
  const double yaw = std::atan2(d.x, d.z) + map.kappa_rad[eye].x;
  const double pitch = std::asin(std::clamp(d.y, -1.0, 1.0)) + map.kappa_rad[eye].y;
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

std::optional<glm::dvec2> pointOnDisplay(const BinocularMap& map, std::size_t eye,
                                         const BinocularSample::Eye& measured) {
  const glm::dmat3 display_from_tracker = glm::transpose(map.rotation);
  const glm::dvec3 from = display_from_tracker * (measured.centre_m - map.translation_m);
  const glm::dvec3 along = display_from_tracker * correctedDirection(map, eye, measured.direction);
  if (along.z == 0.0 || -from.z / along.z <= 0.0) return std::nullopt;
  return glm::dvec2(from - from.z / along.z * along);
}

std::optional<double> vergence_D(const BinocularMap& map, const BinocularSample& sample) {
  if (!sample.eyes[0] || !sample.eyes[1]) return std::nullopt;
  const glm::dvec3 left = correctedDirection(map, 0, sample.eyes[0]->direction);
  const glm::dvec3 right = correctedDirection(map, 1, sample.eyes[1]->direction);
  return vergence_D(EyeRay{.origin_m = sample.eyes[0]->centre_m, .direction = left},
                    EyeRay{.origin_m = sample.eyes[1]->centre_m, .direction = right});
}

BinocularMap roughBinocularMap(std::span<const BinocularSample> samples) {
  // (I - d d') (x r1 + y r2 + t - c) = 0 in the two columns of the rotation and the translation.
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> right = Eigen::Matrix<double, 9, 1>::Zero();
  for (const BinocularSample& sample : samples) {
    for (const auto& eye : sample.eyes) {
      if (!eye || !(glm::length(eye->direction) > 0.0)) continue;
      const glm::dvec3 d = glm::normalize(eye->direction);
      const Eigen::Vector3d along(d.x, d.y, d.z);
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along * along.transpose();
      Eigen::Matrix<double, 3, 9> row;
      row << sample.target_m.x * across, sample.target_m.y * across, across;
      const Eigen::Vector3d centre(eye->centre_m.x, eye->centre_m.y, eye->centre_m.z);
      normal += row.transpose() * row;
      right += row.transpose() * (across * centre);
    }
  }
  const Eigen::Matrix<double, 9, 1> found = normal.ldlt().solve(right);
  const auto column = [&](Eigen::Index i) {
    return glm::dvec3(found[3 * i], found[3 * i + 1], found[3 * i + 2]);
  };
  const glm::dvec3 x = column(0), y = column(1);
  // Of unit length and square to each other but for noise; a plane seen edge-on is neither.
  const double sine = glm::length(glm::cross(x, y)) / (glm::length(x) * glm::length(y));
  if (!found.allFinite() || !(sine > 0.5)) {
    throw InputError("binocular calibration",
                     "the lines of sight do not meet the targets: expected targets over the width "
                     "and height of the display, and eyes that look at them");
  }
  BinocularMap map;
  map.rotation[0] = glm::normalize(x);
  map.rotation[1] = glm::normalize(y - glm::dot(y, map.rotation[0]) * map.rotation[0]);
  map.rotation[2] = glm::cross(map.rotation[0], map.rotation[1]);
  map.translation_m = column(2);
  return map;
}

std::vector<double> errorsOf_deg(const BinocularMap& map,
                                 std::span<const BinocularSample> samples) {
  std::vector<double> errors;
  for (const BinocularSample& sample : samples) {
    const glm::dvec3 target = map.rotation * glm::dvec3(sample.target_m, 0.0) + map.translation_m;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      const glm::dvec3 to = target - sample.eyes[eye]->centre_m;
      const glm::dvec3 sight = correctedDirection(map, eye, sample.eyes[eye]->direction);
      errors.push_back(
          glm::degrees(std::atan2(glm::length(glm::cross(to, sight)), glm::dot(to, sight))));
    }
  }
  return errors;
}

BinocularFit fitBinocular(std::span<const BinocularSample> samples, const BinocularMap& nominal) {
  constexpr const char* kWhere = "binocular calibration";
  std::vector<glm::dvec2> targets;
  std::array<std::size_t, 2> seen{};
  for (const BinocularSample& sample : samples) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      if (!(glm::length(sample.eyes[eye]->direction) > 0.0)) {
        throw InputError(kWhere, "a direction of length 0");
      }
      ++seen[eye];
    }
    if (std::find(targets.begin(), targets.end(), sample.target_m) == targets.end() &&
        targets.size() < kMinBinocularTargets) {
      targets.push_back(sample.target_m);
    }
  }
  if (seen[0] + seen[1] < kMinSamples || targets.size() < kMinBinocularTargets) {
    throw InputError(kWhere, "too few: expected 20 samples or more at 3 targets or more");
  }

  double pose[6];
  ceres::RotationMatrixToAngleAxis(&nominal.rotation[0][0], pose);
  for (int i = 0; i < 3; ++i) pose[3 + i] = nominal.translation_m[i];
  double kappa[2][2] = {{nominal.kappa_rad[0].x, nominal.kappa_rad[0].y},
                        {nominal.kappa_rad[1].x, nominal.kappa_rad[1].y}};

  // The loss needs the residual's scale, which the fit tells: begin wide.
  double sd_rad = glm::radians(3.0);
  BinocularFit fit;
  for (int round = 0; round < kRounds; ++round) {
    ceres::Problem problem;
    std::vector<SightError> costs;
    for (const BinocularSample& sample : samples) {
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!sample.eyes[eye]) continue;
        const SightError cost{*sample.eyes[eye], sample.target_m, sd_rad};
        costs.push_back(cost);
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<SightError, 2, 6, 2>(new SightError(cost)),
            new ceres::CauchyLoss(kCauchy), pose, kappa[eye]);
      }
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.parameter_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);

    std::vector<double> errors;
    std::size_t at = 0;
    double sum = 0.0;
    for (const BinocularSample& sample : samples) {
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!sample.eyes[eye]) continue;
        double residual[2];
        const double error = costs[at++](pose, kappa[eye], residual)
                                 ? sd_rad * std::hypot(residual[0], residual[1])
                                 : 3.14;
        errors.push_back(error);
        sum += error;
      }
    }
    fit.accuracy_deg = glm::degrees(sum / static_cast<double>(errors.size()));
    // Rayleigh's median over its sigma; no tracker is better than a thousandth of a degree.
    const double found = std::max(quantile(errors, 0.5) / 1.1774, glm::radians(0.001));

    if (round == kRounds - 1) {
      ceres::Covariance::Options covariance_options;
      covariance_options.algorithm_type = ceres::DENSE_SVD;
      covariance_options.min_reciprocal_condition_number = 1e-60;
      ceres::Covariance covariance(covariance_options);
      std::vector<std::pair<const double*, const double*>> blocks{{pose, pose}};
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (seen[eye] > 0) blocks.emplace_back(kappa[eye], kappa[eye]);
      }
      if (!covariance.Compute(blocks, &problem)) throw InputError(kWhere, "nothing is determined");
      double of_pose[36];
      covariance.GetCovarianceBlock(pose, pose, of_pose);
      for (int i = 3; i < 6; ++i) {
        fit.translation_sd_m = std::max(fit.translation_sd_m, std::sqrt(std::abs(of_pose[7 * i])));
      }
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (seen[eye] == 0) continue;
        double of_kappa[4];
        covariance.GetCovarianceBlock(kappa[eye], kappa[eye], of_kappa);
        for (int i : {0, 3}) {
          fit.kappa_sd_deg =
              std::max(fit.kappa_sd_deg, glm::degrees(std::sqrt(std::abs(of_kappa[i]))));
        }
      }
    }
    sd_rad = found;
  }
  if (!(fit.translation_sd_m <= kKnown_m && fit.kappa_sd_deg <= kKnown_deg)) {
    throw InputError(
        kWhere, "pose and kappa cannot be told apart: move the head nearer, farther and aside");
  }
  fit.map.rotation = rotationOf(pose);
  fit.map.translation_m = {pose[3], pose[4], pose[5]};
  for (std::size_t eye = 0; eye < 2; ++eye) fit.map.kappa_rad[eye] = {kappa[eye][0], kappa[eye][1]};
  BinocularMap uncorrected = fit.map;
  uncorrected.kappa_rad = {};
  fit.vergence_bias_before_D = medianVergenceError_D(samples, uncorrected, fit.map);
  fit.vergence_bias_after_D = medianVergenceError_D(samples, fit.map, fit.map);
  return fit;
}

}  // namespace foci
