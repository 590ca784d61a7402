#include "gaze/webcam/head_pose.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace foci {
namespace {

constexpr double kMinSpread_px = 0.15;  // scatter of good matches
constexpr double kTukey = 4.685;  // 95 % efficiency for normal errors (Holland and Welsch 1977)

/// Rotation about a vector by its length (Rodrigues).
glm::dmat3 rotation(const glm::dvec3& turn) {
  const double angle = glm::length(turn);
  if (angle < 1e-12) return glm::dmat3(1.0);
  const glm::dvec3 a = turn / angle;
  const glm::dmat3 cross(0.0, a.z, -a.y, -a.z, 0.0, a.x, a.y, -a.x, 0.0);
  return glm::dmat3(1.0) + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

/// Gram-Schmidt orthonormalisation, so that rounding errors do not accumulate.
glm::dmat3 orthonormal(const glm::dmat3& m) {
  const glm::dvec3 x = glm::normalize(m[0]);
  const glm::dvec3 y = glm::normalize(m[1] - glm::dot(m[1], x) * x);
  return {x, y, glm::cross(x, y)};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Pinhole usualPinhole(const glm::ivec2& size_px) {
  const double focal = 0.5 * size_px.x / std::tan(glm::radians(30.0));
  return {.focal_px = glm::dvec2(focal), .principal_px = 0.5 * glm::dvec2(size_px)};
}

glm::dvec2 project(const Pinhole& camera, const HeadPose& pose, const glm::dvec3& p_head_mm) {
  const glm::dvec3 p = pose.camera_from_head * p_head_mm + pose.position_mm;
  return camera.focal_px * glm::dvec2(p) / p.z + camera.principal_px;
}

double angleBetween_rad(const glm::dmat3& a, const glm::dmat3& b) {
  const glm::dmat3 turn = glm::transpose(a) * b;
  return std::acos(std::clamp(0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1.0), -1.0, 1.0));
}

std::optional<double> faceDepth_mm(double x, double y) {
  // Dimensions of an average face, chosen by eye. Below the eyes the profile without its nose runs
  // straight down. Above the eyes the forehead leans back.
  constexpr double kHalfWidth_mm = 80.0, kForehead_mm = 120.0, kProfile_mm = 190.0, kDeep_mm = 92.0;
  constexpr double kBrow_mm = -21.0;  // z between the brows
  constexpr double kNose_mm = 20.0, kNoseTip_mm = 43.0, kNoseEnd_mm = 56.0,
                   kNoseHalfWidth_mm = 17.0;
  const double half_height = y < 0.0 ? kForehead_mm : kProfile_mm;
  const double inside = 1.0 - std::pow(x / kHalfWidth_mm, 2) - std::pow(y / half_height, 2);
  if (inside < 0.05) return std::nullopt;
  double z = kBrow_mm + kDeep_mm * (1.0 - std::sqrt(inside));
  const double along = y < 0.0           ? 0.0
                       : y < kNoseTip_mm ? y / kNoseTip_mm
                                         : (kNoseEnd_mm - y) / (kNoseEnd_mm - kNoseTip_mm);
  const double across = 1.0 - std::abs(x) / kNoseHalfWidth_mm;
  if (along > 0.0 && across > 0.0) z -= kNose_mm * along * across;
  return z;
}

glm::dvec3 onHeadPlane_mm(const Pinhole& camera, const HeadPose& pose, const glm::dvec2& point_px,
                          double z_mm) {
  const glm::dmat3 head_from_camera = glm::transpose(pose.camera_from_head);
  const glm::dvec3 direction =
      head_from_camera * glm::dvec3((point_px - camera.principal_px) / camera.focal_px, 1.0);
  const glm::dvec3 origin = head_from_camera * -pose.position_mm;
  return origin + direction * ((z_mm - origin.z) / direction.z);
}

std::optional<glm::dvec3> onFace_mm(const Pinhole& camera, const HeadPose& pose,
                                    const glm::dvec2& point_px) {
  double z = -20.0;
  glm::dvec3 p{0.0};
  for (int i = 0; i < 24; ++i) {
    p = onHeadPlane_mm(camera, pose, point_px, z);
    const auto depth = faceDepth_mm(p.x, p.y);
    if (!depth) return std::nullopt;
    z = 0.5 * (z + *depth);  // half steps converge on the steep sides of the nose, too
  }
  return p;
}

std::optional<HeadPoseFit> fitHeadPose(const Pinhole& camera, std::span<const glm::dvec3> points_mm,
                                       std::span<const glm::dvec2> image_px,
                                       std::span<const double> weights, const HeadPose& start) {
  assert(points_mm.size() == image_px.size() && points_mm.size() == weights.size());
  constexpr std::size_t kMinPoints = 6;
  if (points_mm.size() < kMinPoints) return std::nullopt;
  HeadPoseFit fit{.pose = start};
  std::vector<double> off(points_mm.size());
  constexpr int kRounds = 12;
  for (int round = 0; round <= kRounds; ++round) {
    for (std::size_t i = 0; i < off.size(); ++i) {
      const glm::dvec3 p = fit.pose.camera_from_head * points_mm[i] + fit.pose.position_mm;
      if (!(p.z > 1.0)) return std::nullopt;
      off[i] = std::sqrt(weights[i]) *
               glm::distance(project(camera, fit.pose, points_mm[i]), image_px[i]);
    }
    const double spread = std::max(1.4826 * median(off), kMinSpread_px);
    const double limit = kTukey * spread;
    if (round == kRounds) {
      double count = 0.0, sum2 = 0.0;
      for (const double o : off) {
        if (o >= limit) continue;
        ++count;
        sum2 += o * o;
      }
      fit.inliers = count / static_cast<double>(off.size());
      fit.rms_px = std::sqrt(sum2 / std::max(1.0, count));
      break;
    }
    cv::Matx66d normal = cv::Matx66d::zeros();
    cv::Vec6d rhs = cv::Vec6d::all(0.0);
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (off[i] >= limit) continue;
      const double w = weights[i] * std::pow(1.0 - std::pow(off[i] / limit, 2), 2);
      const glm::dvec3 turned = fit.pose.camera_from_head * points_mm[i];
      const glm::dvec3 p = turned + fit.pose.position_mm;
      const glm::dvec2 miss = image_px[i] - project(camera, fit.pose, points_mm[i]);
      for (int axis = 0; axis < 2; ++axis) {
        const double f = camera.focal_px[axis];
        glm::dvec3 by_place(0.0);
        by_place[axis] = f / p.z;
        by_place.z = -f * p[axis] / (p.z * p.z);
        const glm::dvec3 by_turn = glm::cross(turned, by_place);
        const cv::Vec6d j(by_turn.x, by_turn.y, by_turn.z, by_place.x, by_place.y, by_place.z);
        for (int a = 0; a < 6; ++a) {
          rhs[a] += w * j[a] * miss[axis];
          for (int b = 0; b < 6; ++b) normal(a, b) += w * j[a] * j[b];
        }
      }
    }
    for (int a = 0; a < 6; ++a) normal(a, a) *= 1.0 + 1e-6;
    cv::Vec6d step;
    if (!cv::solve(normal, rhs, step, cv::DECOMP_CHOLESKY)) return std::nullopt;
    fit.pose.camera_from_head =
        orthonormal(rotation({step[0], step[1], step[2]}) * fit.pose.camera_from_head);
    fit.pose.position_mm += glm::dvec3(step[3], step[4], step[5]);
    const double moved =
        std::hypot(step[3], step[4], step[5]) + 100.0 * std::hypot(step[0], step[1], step[2]);
    if (!std::isfinite(moved)) return std::nullopt;
    if (moved < 1e-3 && round >= 2) round = kRounds - 1;
  }
  return fit;
}

}  // namespace foci
