#include "gaze/webcam/head_tracker.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/quantile.h"

namespace foci {
namespace {

// Constants were chosen by hand. WebcamTracker's tests on rendered faces bound them.
constexpr int kMaxPoints = 110;
constexpr std::size_t kMaxViews = 24;
constexpr double kCutOut_mm = 210.0;     // side of the cut-out
constexpr double kCutOutDown_mm = 15.0;  // from the eyes down to its centre
const cv::Size kPatch{21, 21};
constexpr int kLevels = 2;
// A view serves for poses up to this rotation and change of scale. Beyond, a new view is kept.
constexpr double kTurn_rad = 0.12, kScale = 0.10;
// A fit must have as many inliers, a smaller error, and a pose closer to its view (in units of the
// two constants above): far from the view, patches look different.
constexpr double kMinInliers = 0.45, kMaxRms_px = 1.5, kMaxUnlike = 2.5;

/// Whether a point belongs to the rigid part of the face: not to the eyes, the mouth or the
/// outline.
bool isRigid(const glm::dvec3& p) {
  const auto within = [&](double x, double y, double half_x, double half_y) {
    return std::pow((std::abs(p.x) - x) / half_x, 2) + std::pow((p.y - y) / half_y, 2) < 1.0;
  };
  const bool face = within(0.0, 0.0, 54.0, 70.0);  // the outline slides when the head turns
  const bool eye = within(0.5 * kMeanIpd_mm, 0.0, 20.0, 12.0);
  const bool mouth = within(0.0, 75.0, 32.0, 18.0);
  return face && !eye && !mouth;
}

/// The image minus its local mean, so that changes of light have little effect.
cv::Mat withoutLight(const cv::Mat& grey) {
  cv::Mat smooth, mean, flat;
  cv::GaussianBlur(grey, smooth, {5, 5}, 1.0, 1.0, cv::BORDER_REPLICATE);  // against noise
  const int side = std::max(9, grey.cols / 12 * 2 + 1);
  cv::blur(smooth, mean, {side, side}, {-1, -1}, cv::BORDER_REPLICATE);
  cv::addWeighted(smooth, 2.0, mean, -2.0, 128.0, flat);
  return flat;
}

/// A cut-out that may reach beyond the frame. Pixels outside the frame are grey.
cv::Mat cutOut(const cv::Mat& grey, const cv::Point& corner, const cv::Size& size) {
  const cv::Rect wanted(corner, size), there = wanted & cv::Rect({0, 0}, grey.size());
  cv::Mat cut(size, CV_8UC1, cv::Scalar(128));
  if (!there.empty()) grey(there).copyTo(cut(there - corner));
  return cut;
}

cv::Point cutOutCorner(const Pinhole& camera, const HeadPose& pose, const cv::Size& size) {
  const glm::dvec2 centre = project(camera, pose, {0.0, kCutOutDown_mm, 0.0});
  return {cvRound(centre.x - 0.5 * size.width), cvRound(centre.y - 0.5 * size.height)};
}

/// How different a head looks in two poses. Above 1, another view is needed.
double unlike(const HeadPose& a, const HeadPose& b) {
  return std::hypot(angleBetween_rad(a.camera_from_head, b.camera_from_head) / kTurn_rad,
                    std::log(a.position_mm.z / b.position_mm.z) / kScale);
}

constexpr double kMinSpread_px = 0.15;  // scatter of good matches

/// Rotation about a vector by its length (Rodrigues).
glm::dmat3 rotation(const glm::dvec3& turn) {
  const double angle = glm::length(turn);
  if (angle < 1e-12) return glm::dmat3(1.0);
  const glm::dvec3 a = turn / angle;
  const glm::dmat3 cross(0.0, a.z, -a.y, -a.z, 0.0, a.x, a.y, -a.x, 0.0);
  return glm::dmat3(1.0) + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

}  // namespace

glm::dmat3 orthonormal(const glm::dmat3& m) {
  const glm::dvec3 x = glm::normalize(m[0]);
  const glm::dvec3 y = glm::normalize(m[1] - glm::dot(m[1], x) * x);
  return {x, y, glm::cross(x, y)};
}

HeadPose HeadTracker::frontal(const Pinhole& camera, const std::array<glm::dvec2, 2>& irises_px) {
  const auto along = [&](const glm::dvec2& px) {
    return glm::dvec3((px - camera.principal_px) / camera.focal_px, 1.0);
  };
  const glm::dvec3 left = along(irises_px[0]), right = along(irises_px[1]);
  const glm::dvec2 between(left - right);
  const double roll = std::atan2(between.y, between.x);
  const double depth = kMeanIpd_mm / glm::length(between);
  HeadPose pose;
  pose.camera_from_head = glm::dmat3(std::cos(roll), std::sin(roll), 0.0, -std::sin(roll),
                                     std::cos(roll), 0.0, 0.0, 0.0, 1.0);
  pose.position_mm = 0.5 * (left + right) * depth - glm::dvec3(0.0, 0.0, kIrisDepth_mm);
  return pose;
}

void HeadTracker::start(const cv::Mat& grey, const HeadPose& pose) {
  views_.clear();
  pose_ = pose;
  keep(grey, pose_);
}

void HeadTracker::start(const HeadView& view) {
  views_.clear();
  pose_ = view.pose;
  keep(view);
}

void HeadTracker::keep(const cv::Mat& grey, const HeadPose& pose) {
  const int side = cvRound(kCutOut_mm * camera_.focal_px.x / pose.position_mm.z) / 4 * 4;
  const cv::Size size(side, side);
  const cv::Point corner = cutOutCorner(camera_, pose, size);
  keep(HeadView{cutOut(grey, corner, size), {corner.x, corner.y}, pose});
}

void HeadTracker::keep(HeadView view) {
  KeptView kept;
  kept.view = std::move(view);
  const cv::Mat flat = withoutLight(kept.view.grey);
  // Find corners on the rigid part of the face, spread over it.
  cv::Mat mask(flat.size(), CV_8UC1, cv::Scalar(0));
  constexpr int kCell_px = 4;
  for (int y = 0; y < mask.rows; y += kCell_px) {
    for (int x = 0; x < mask.cols; x += kCell_px) {
      const glm::dvec2 px = kept.view.corner_px + glm::dvec2(x, y) + 0.5 * kCell_px;
      const auto p = onFace_mm(camera_, kept.view.pose, px);
      if (p && isRigid(*p)) {
        mask(cv::Rect(x, y, kCell_px, kCell_px) & cv::Rect({0, 0}, mask.size())) = 255;
      }
    }
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(flat, corners, kMaxPoints, 0.003, std::max(3.0, flat.cols / 24.0), mask,
                          5);
  // The structure of a patch along its weaker direction decides how exactly it is found again.
  cv::Mat1f structure;
  cv::cornerMinEigenVal(flat, structure, kPatch.width);
  for (const cv::Point2f& corner : corners) {
    const glm::dvec2 px = kept.view.corner_px + glm::dvec2(corner.x + 0.5, corner.y + 0.5);
    if (const auto p = onFace_mm(camera_, kept.view.pose, px)) {
      kept.points_px.push_back(corner);
      kept.weights.push_back(static_cast<double>(structure(cvRound(corner.y), cvRound(corner.x))));
      kept.points_mm.push_back(*p);
    }
  }
  if (!kept.weights.empty()) {
    const double best = *std::ranges::max_element(kept.weights);
    constexpr double kExactEnough = 0.15;  // of the best; above, the average face is the limit
    for (double& w : kept.weights) w = std::min(1.0, w / (kExactEnough * std::max(best, 1e-12)));
  }
  cv::buildOpticalFlowPyramid(flat, kept.pyramid, kPatch, kLevels, true);
  // The first view always stays. Of the others the oldest makes room.
  if (views_.size() == kMaxViews) views_.erase(views_.begin() + 1);
  views_.push_back(std::move(kept));
}

std::size_t HeadTracker::nearestView(const HeadPose& pose) const {
  const auto nearest = std::ranges::min_element(
      views_, {}, [&](const KeptView& kept) { return unlike(kept.view.pose, pose); });
  return static_cast<std::size_t>(nearest - views_.begin());
}

std::optional<HeadPoseFit> HeadTracker::follow(const cv::Mat& grey,
                                               const std::optional<HeadPose>& guess) {
  const HeadPose from = guess.value_or(pose_);
  const KeptView& kept = views_[nearestView(from)];
  const cv::Size size = kept.view.grey.size();
  // Find the patches of the nearest view in the frame.
  const cv::Point corner = cutOutCorner(camera_, from, size);
  const cv::Mat flat = withoutLight(cutOut(grey, corner, size));
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(flat, pyramid, kPatch, kLevels, false);
  const glm::dvec2 origin(corner.x, corner.y);
  std::vector<cv::Point2f> seen(kept.points_px.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const glm::dvec2 at = project(camera_, from, kept.points_mm[i]) - origin - 0.5;
    seen[i] = {static_cast<float>(at.x), static_cast<float>(at.y)};
  }
  if (seen.empty()) return std::nullopt;
  std::vector<unsigned char> found;
  std::vector<float> difference;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 15, 0.01);
  cv::calcOpticalFlowPyrLK(kept.pyramid, pyramid, kept.points_px, seen, found, difference, kPatch,
                           kLevels, stop, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  std::vector<glm::dvec3> points_mm;
  std::vector<glm::dvec2> image_px;
  std::vector<double> weights;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!found[i]) continue;
    points_mm.push_back(kept.points_mm[i]);
    weights.push_back(kept.weights[i]);
    image_px.push_back(origin + glm::dvec2(seen[i].x + 0.5, seen[i].y + 0.5));
  }
  // Fit the pose.
  const auto found_pose = fitHeadPose(camera_, points_mm, image_px, weights, from);
  if (!found_pose) return std::nullopt;
  HeadPoseFit fit = *found_pose;
  fit.inliers *= static_cast<double>(points_mm.size()) / static_cast<double>(seen.size());
  const double limit_px = kMaxRms_px * std::max(1.0, size.width / 240.0);
  const bool is_far = unlike(fit.pose, kept.view.pose) > kMaxUnlike;
  if (fit.inliers < kMinInliers || fit.rms_px > limit_px || is_far) return std::nullopt;
  pose_ = fit.pose;
  if (unlike(fit.pose, views_[nearestView(fit.pose)].view.pose) > 1.0) keep(grey, fit.pose);
  return fit;
}

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
  std::vector<double> off(points_mm.size()), sorted;
  constexpr int kRounds = 12;
  for (int round = 0; round <= kRounds; ++round) {
    for (std::size_t i = 0; i < off.size(); ++i) {
      const glm::dvec3 p = fit.pose.camera_from_head * points_mm[i] + fit.pose.position_mm;
      if (!(p.z > 1.0)) return std::nullopt;
      off[i] = std::sqrt(weights[i]) *
               glm::distance(project(camera, fit.pose, points_mm[i]), image_px[i]);
    }
    sorted = off;
    const double spread = std::max(kSigmaPerMad * quantile(sorted, 0.5), kMinSpread_px);
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
