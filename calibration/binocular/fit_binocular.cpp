#include "calibration/binocular/fit_binocular.h"

#include <ceres/rotation.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "calibration/location.h"
#include "calibration/screen/screen_size.h"
#include "calibration/solve.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr const char* kWhere = "binocular calibration";
constexpr std::size_t kMinSamples = 20, kMinBinocularTargets = 3;
constexpr double kCauchy = 2.0;  // in deviations; 2.385 is 95 % efficient (Holland and Welsch 1977)
constexpr double kKnown_m = 0.02, kKnown_deg = 1.0;
constexpr int kRounds = 3;            // fits, each with the scale that the previous one left
constexpr double kStartSd_deg = 3.0;  // wider than the errors of any tracker before kappa is known
constexpr double kMinSd_deg = 0.001;  // no tracker is better

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

/// Pose of the display and kappa of each eye, as Ceres moves them.
struct Unknowns {
  double pose[6];  // angle-axis, then translation
  double kappa[2][2];
};

Unknowns startOf(const BinocularMap& nominal) {
  Unknowns start{};
  ceres::RotationMatrixToAngleAxis(&nominal.rotation[0][0], start.pose);
  for (int i = 0; i < 3; ++i) start.pose[3 + i] = nominal.translation_m[i];
  for (int eye = 0; eye < 2; ++eye) {
    for (int axis = 0; axis < 2; ++axis) {
      start.kappa[eye][axis] = nominal.kappa_rad[static_cast<std::size_t>(eye)][axis];
    }
  }
  return start;
}

glm::dmat3 rotationOf(const double* angle_axis) {
  double column_major[9];
  ceres::AngleAxisToRotationMatrix(angle_axis, column_major);
  glm::dmat3 rotation;
  for (int i = 0; i < 9; ++i) rotation[i / 3][i % 3] = column_major[i];
  return rotation;
}

BinocularMap mapOf(const Unknowns& found) {
  BinocularMap map;
  map.rotation = rotationOf(found.pose);
  map.translation_m = {found.pose[3], found.pose[4], found.pose[5]};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    map.kappa_rad[eye] = {found.kappa[eye][0], found.kappa[eye][1]};
  }
  return map;
}

/// Number of samples of each eye.
/// @throws InputError where samples or targets are too few, or a direction has no length
std::array<std::size_t, 2> countEyes(std::span<const BinocularSample> samples) {
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
    if (std::ranges::find(targets, sample.target_m) == targets.end() &&
        targets.size() < kMinBinocularTargets) {
      targets.push_back(sample.target_m);
    }
  }
  if (seen[0] + seen[1] < kMinSamples || targets.size() < kMinBinocularTargets) {
    throw InputError(kWhere, "too few: expected 20 samples or more at 3 targets or more");
  }
  return seen;
}

/// Adds the residuals of all eyes and minimises them.
void adjust(std::span<const BinocularSample> samples, double sd_rad, ceres::Problem& problem,
            Unknowns& unknowns) {
  for (const BinocularSample& sample : samples) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SightError, 2, 6, 2>(
                                   new SightError{*sample.eyes[eye], sample.target_m, sd_rad}),
                               new ceres::CauchyLoss(kCauchy), unknowns.pose, unknowns.kappa[eye]);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  solve(options, problem, kWhere);
}

/// Angle between each line of sight and its target; pi where the eye lies on the target.
std::vector<double> missesOf_rad(std::span<const BinocularSample> samples, double sd_rad,
                                 const Unknowns& found) {
  std::vector<double> misses;
  for (const BinocularSample& sample : samples) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      double residual[2];
      const SightError cost{*sample.eyes[eye], sample.target_m, sd_rad};
      misses.push_back(cost(found.pose, found.kappa[eye], residual)
                           ? sd_rad * std::hypot(residual[0], residual[1])
                           : 3.14);
    }
  }
  return misses;
}

constexpr const char* kConvert = ", convert the columns that end in _mm to mm";

/// Eyes too near each other or too far apart are in another unit.
/// @return what is unusual about their distance; empty: nothing
std::string judgeUnits(std::span<const BinocularSample> samples) {
  constexpr double kLeast_mm = 15.0, kMost_mm = 150.0;  // of a marmoset, and far beyond a human
  std::vector<double> apart_mm;
  for (const BinocularSample& sample : samples) {
    const auto &left = sample.eyes[0], &right = sample.eyes[1];
    if (left && right) apart_mm.push_back(1e3 * glm::distance(left->centre_m, right->centre_m));
  }
  if (apart_mm.empty()) return "";
  const double ipd_mm = quantile(apart_mm, 0.5);
  if (ipd_mm >= kMinIpd_mm && ipd_mm <= kMaxIpd_mm) return "";
  const std::string found = "left_origin_..._mm and right_origin_..._mm are " +
                            significant(ipd_mm) + " mm apart: expected ";
  if (ipd_mm >= kLeast_mm && ipd_mm <= kMost_mm) {
    return found + exactText(kMinIpd_mm) + " to " + exactText(kMaxIpd_mm) + " of an adult";
  }
  throw InputError(kWhere, found + exactText(kLeast_mm) + " to " + exactText(kMost_mm) + kConvert);
}

/// Refuses an impossible distance, mirrored targets and exchanged eyes.
/// @return what is unusual about the tracker's frame; empty: nothing
std::string judgeAxes(std::span<const BinocularSample> samples, const BinocularMap& map) {
  const glm::dmat3 display_from_tracker = glm::transpose(map.rotation);
  std::vector<double> in_front, to_right;  // m, of an eye; from the left eye to the right one
  for (const BinocularSample& sample : samples) {
    const auto &left = sample.eyes[0], &right = sample.eyes[1];
    for (const auto& eye : sample.eyes) {
      if (!eye) continue;
      in_front.push_back((display_from_tracker * (eye->centre_m - map.translation_m)).z);
    }
    if (!left || !right) continue;
    to_right.push_back((display_from_tracker * (right->centre_m - left->centre_m)).x);
  }
  const double distance_m = quantile(in_front, 0.5);
  if (!(std::abs(distance_m) >= kMinDistance_m && std::abs(distance_m) <= kMaxDistance_m)) {
    throw InputError(kWhere, "the eyes are " + significant(1e3 * std::abs(distance_m)) +
                                 " mm from the display: expected " +
                                 exactText(1e3 * kMinDistance_m) + " to " +
                                 exactText(1e3 * kMaxDistance_m) + kConvert);
  }
  const bool faces_eyes = distance_m > 0.0, y_is_up = map.rotation[1].y > 0.0;
  const bool x_is_right = map.rotation[0].x > 0.0;
  const bool in_order = to_right.empty() || quantile(to_right, 0.5) > 0.0;
  // A camera that faces the observer: as the eyes tell, it was turned, not mirrored.
  if (!x_is_right && faces_eyes && in_order && !to_right.empty()) {
    return "the tracker's x leads to the observer's left" +
           std::string(y_is_up ? " and its z away from the observer" : " and its y down") +
           ": taken so; expected x right, y up, z towards the observer";
  }
  const auto refuseAxis = [](const std::string& axis, const std::string& to) {
    throw InputError(kWhere, axis + "_target_mm runs against " + axis +
                                 " of the tracker: expected both " + to +
                                 ", change the sign of the one that is not");
  };
  if (!x_is_right) refuseAxis("x", "to the right");
  if (!y_is_up && !faces_eyes) refuseAxis("y", "up");
  if (!in_order) {
    throw InputError(kWhere,
                     "the left eye is to the right of the right one: expected left_origin_x_mm "
                     "below right_origin_x_mm, exchange the columns left_... and right_...");
  }
  if (y_is_up && faces_eyes) return "";
  return "the tracker's z leads away from the observer" +
         std::string(y_is_up ? "" : " and its y down") +
         ": taken so, if y_target_mm runs up; expected x right, y up, z towards the observer";
}

/// Largest deviations of translation and kappa, from the covariance.
void takeDeviations(ceres::Problem& problem, const Unknowns& found,
                    const std::array<std::size_t, 2>& seen, BinocularFit& fit) {
  const std::vector<double> of_pose = variancesOf(problem, found.pose);
  if (of_pose.empty()) throw InputError(kWhere, "nothing is determined");
  for (const double variance : std::span(of_pose).last(3)) {
    fit.translation_sd_m = std::max(fit.translation_sd_m, std::sqrt(std::abs(variance)));
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (seen[eye] == 0) continue;
    for (const double variance : variancesOf(problem, found.kappa[eye])) {
      fit.kappa_sd_deg = std::max(fit.kappa_sd_deg, glm::degrees(std::sqrt(std::abs(variance))));
    }
  }
}

/// Median of the vergence that `map` gives minus the vergence that the targets ask for.
double medianVergenceError_D(std::span<const BinocularSample> samples, const BinocularMap& map,
                             const BinocularMap& truth) {
  std::vector<double> errors;
  for (const BinocularSample& sample : samples) {
    const auto vergence = vergence_D(map, sample);
    if (!vergence) continue;
    const glm::dvec3 target =
        truth.rotation * glm::dvec3(sample.target_m, 0.0) + truth.translation_m;
    const glm::dvec3 middle = 0.5 * (sample.eyes[0]->centre_m + sample.eyes[1]->centre_m);
    errors.push_back(*vergence - 1.0 / glm::length(target - middle));
  }
  return errors.empty() ? 0.0 : quantile(errors, 0.5);
}

constexpr std::array<const char*, 6> kOfEye{"origin_x_mm", "origin_y_mm", "origin_z_mm",
                                            "direction_x", "direction_y", "direction_z"};
constexpr double kMaxDistance_mm = 1e5, kMaxLength = 1e6, kMinLength = 1e-6;
constexpr std::size_t kMaxRows = 2'000'000;

using EyeAt = std::array<std::size_t, kOfEye.size()>;

/// @param eye  "left_", "right_" @return nothing if the table has no column of it
std::optional<EyeAt> eyeColumnsOf(const NamedTable& table, const std::string& eye) {
  if (std::ranges::none_of(kOfEye,
                           [&](const char* name) { return table.find(eye + name).has_value(); })) {
    return std::nullopt;
  }
  EyeAt columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = table.column(eye + kOfEye[i]);
  return columns;
}

/// @return nothing in data loss
std::optional<BinocularSample::Eye> eyeIn(NamedTable& table, const EyeAt& columns) {
  std::array<double, kOfEye.size()> values{};
  bool complete = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double max = i < 3 ? kMaxDistance_mm : kMaxLength;
    const auto value = table.number(columns[i], -max, max);
    complete &= value.has_value();
    values[i] = value.value_or(0.0);
  }
  if (!complete) return std::nullopt;
  const glm::dvec3 direction(values[3], values[4], values[5]);
  if (!(glm::length(direction) > kMinLength)) throw table.error("a direction of length 0");
  return BinocularSample::Eye{.centre_m = 1e-3 * glm::dvec3(values[0], values[1], values[2]),
                              .direction = direction};
}

}  // namespace

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
  // Without noise both columns are unit and orthogonal; a plane seen edge-on gives neither.
  const double sine = glm::length(glm::cross(x, y)) / (glm::length(x) * glm::length(y));
  if (!found.allFinite() || !(sine > 0.5)) {
    throw InputError(kWhere,
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

BinocularFit fitBinocular(std::span<const BinocularSample> samples, const BinocularMap& nominal) {
  const std::array<std::size_t, 2> seen = countEyes(samples);
  const std::string of_units = judgeUnits(samples);
  Unknowns unknowns = startOf(nominal);

  // The loss needs the residual's scale, which only a fit tells: begin wide and repeat.
  double sd_rad = glm::radians(kStartSd_deg);
  BinocularFit fit;
  for (int round = 0; round < kRounds; ++round) {
    ceres::Problem problem;
    adjust(samples, sd_rad, problem, unknowns);
    if (round == kRounds - 1) takeDeviations(problem, unknowns, seen, fit);
    std::vector<double> misses = missesOf_rad(samples, sd_rad, unknowns);
    const double sum = std::accumulate(misses.begin(), misses.end(), 0.0);
    fit.accuracy_deg = glm::degrees(sum / static_cast<double>(misses.size()));
    sd_rad = std::max(quantile(misses, 0.5) / kRayleighMedian, glm::radians(kMinSd_deg));
  }
  if (!(fit.translation_sd_m <= kKnown_m && fit.kappa_sd_deg <= kKnown_deg)) {
    throw InputError(kWhere,
                     "pose and kappa cannot be separated: move the head nearer, farther and aside");
  }

  fit.map = mapOf(unknowns);
  for (const std::string& warning : {of_units, judgeAxes(samples, fit.map)}) {
    if (!warning.empty()) fit.warnings.push_back(warning);
  }
  BinocularMap uncorrected = fit.map;
  uncorrected.kappa_rad = {};
  fit.vergence_bias_before_D = medianVergenceError_D(samples, uncorrected, fit.map);
  fit.vergence_bias_after_D = medianVergenceError_D(samples, fit.map, fit.map);
  return fit;
}

std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file) {
  NamedTable table(file, "left_origin_x_mm ... right_direction_z, x_target_mm y_target_mm");
  const std::array target{table.column("x_target_mm"), table.column("y_target_mm")};
  const std::array eyes{eyeColumnsOf(table, "left_"), eyeColumnsOf(table, "right_")};
  if (!eyes[0] && !eyes[1]) table.column("left_origin_x_mm");  // throws
  std::vector<BinocularSample> samples;
  while (table.next()) {
    if (samples.size() == kMaxRows) throw table.error("more than 2000000 rows");
    BinocularSample& sample = samples.emplace_back();
    for (const std::size_t axis : {0, 1}) {
      const auto value = table.position(target[axis], axis, -kMaxDistance_mm, kMaxDistance_mm);
      if (!value) throw table.error("a row without a target");
      sample.target_m[static_cast<int>(axis)] = 1e-3 * *value;
    }
    for (const std::size_t side : {0, 1}) {
      if (eyes[side]) sample.eyes[side] = eyeIn(table, *eyes[side]);
    }
  }
  if (samples.empty()) throw InputError(table.fileName(), "no rows below the header");
  return samples;
}

}  // namespace foci
