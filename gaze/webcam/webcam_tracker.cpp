#include "gaze/webcam/webcam_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace foci {
namespace {

constexpr double kEyeWidth_mm = 30.0;
constexpr double kLimbus_mm = 5.9;  // radius (Hall et al. 1985)
// How far the iris may be from where it rests: eyes turn by up to 30 degrees, and rest is a guess.
const glm::dvec2 kReach_mm{8.5, 6.5};
constexpr double kShut = 0.45;  // of the usual contrast: the lid hides the iris
constexpr double kMinConfidence = 0.2;
constexpr double kMemory = 0.03;  // of the usual values, a frame
constexpr int kSearchEvery = 3;   // frames without a face between searches for one
constexpr int kMaxFailures = 5;   // then it is somebody else, or in another light

double quality(const Iris& iris, double usual_contrast) {
  return iris.confidence * std::min(1.0, iris.contrast / std::max(usual_contrast, 20.0));
}

}  // namespace

WebcamTracker::WebcamTracker(const std::optional<Lens>& camera,
                             const std::optional<WebcamReference>& reference)
    : camera_(camera), given_(reference) {
  radius_mm_ = {kLimbus_mm, kLimbus_mm};
  if (reference && !camera) camera_ = reference->camera;
}

std::optional<WebcamReference> WebcamTracker::reference() const {
  if (!head_ || !head_->started()) return std::nullopt;
  return WebcamReference{*camera_, head_->firstView(), eyes_mm_};
}

bool WebcamTracker::findHead(const cv::Mat& grey) {
  const auto face = finder_.find(grey);
  if (!face) return false;
  if (given_) {
    head_->start(given_->view);
    eyes_mm_ = given_->eyes_mm;
    given_.reset();
  }
  const HeadPose frontal = HeadTracker::frontal(*camera_, face->eyes_px);
  if (head_->started() && failures_ < kMaxFailures) {
    if (head_->follow(grey, frontal)) {
      failures_ = 0;
      return true;
    }
    ++failures_;
    return false;
  }
  failures_ = 0;
  head_->start(grey, face->eyes_px);
  for (std::size_t i = 0; i < 2; ++i) {
    eyes_mm_[i] = onHeadPlane_mm(*camera_, head_->pose(), face->eyes_px[i], kIrisDepth_mm);
    offset_mm_[i] = glm::dvec2(0.0);
    usual_contrast_[i] = 0.0;
    radius_mm_[i] = kLimbus_mm;
  }
  know_apart_ = false;
  return true;
}

std::optional<Iris> WebcamTracker::findIris(const cv::Mat& grey, std::size_t eye) const {
  const HeadPose& pose = head_->pose();
  const double px_per_mm = camera_->focal_px.x / pose.position_mm.z;
  const double radius_px = radius_mm_[eye] * px_per_mm;
  const glm::dvec2 rest_px = project(*camera_, pose, eyes_mm_[eye]);
  constexpr std::size_t kCandidates = 2;
  std::vector<glm::dvec2> places;
  for (const IrisCandidate& candidate :
       coarseIrises(grey, rest_px, kReach_mm * px_per_mm, radius_px, kCandidates)) {
    places.push_back(candidate.centre_px);
  }
  places.push_back(project(*camera_, pose, eyes_mm_[eye] + glm::dvec3(offset_mm_[eye], 0.0)));
  std::optional<Iris> best;
  for (const glm::dvec2& place : places) {
    const auto iris = refineIris(grey, place, radius_px);
    if (!iris) continue;
    const glm::dvec2 off = glm::abs(iris->centre_px - rest_px) / px_per_mm / kReach_mm;
    if (off.x > 1.2 || off.y > 1.2) continue;
    if (!best || quality(*iris, usual_contrast_[eye]) > quality(*best, usual_contrast_[eye])) {
      best = iris;
    }
  }
  return best;
}

WebcamRecord WebcamTracker::push(const cv::Mat& image) {
  WebcamRecord record;
  if (!camera_) {
    const glm::ivec2 size_px(image.cols, image.rows);
    camera_ = Lens{usualPinhole(size_px), {}, size_px};
  }
  if (!straight_) straight_.emplace(*camera_);
  if (!head_) head_.emplace(*camera_);
  const cv::Mat& grey = straight_->of(image);

  // Follow the head, or look for it.
  double rigid = 0.0;
  if (head_->started()) {
    const auto fit = head_->follow(grey);
    if (!fit && following_) frames_lost_ = 0;
    following_ = fit.has_value();
    rigid = fit ? fit->inliers : 0.0;
  }
  if (!following_) {
    if (frames_lost_++ % kSearchEvery != 0 || !findHead(grey)) return record;
    following_ = true;
    rigid = 0.5;
  }
  record.face = true;
  const HeadPose& pose = head_->pose();
  const double px_per_mm = camera_->focal_px.x / pose.position_mm.z;
  record.ipd_px = kBetweenEyes_mm * px_per_mm;

  // The irises, in the head's own frame.
  std::array<bool, 2> open{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto iris = findIris(grey, i);
    if (!iris) continue;
    open[i] = iris->confidence > kMinConfidence && iris->contrast > kShut * usual_contrast_[i];
    if (!open[i]) continue;
    record.irises[i] = iris;
    const double memory = usual_contrast_[i] > 0.0 ? kMemory : 1.0;
    usual_contrast_[i] += memory * (iris->contrast - usual_contrast_[i]);
    radius_mm_[i] += kMemory * (iris->radius_px / px_per_mm - radius_mm_[i]);
    radius_mm_[i] = std::clamp(radius_mm_[i], 0.85 * kLimbus_mm, 1.15 * kLimbus_mm);
    const glm::dvec3 seen = onHeadPlane_mm(*camera_, pose, iris->centre_px, eyes_mm_[i].z);
    offset_mm_[i] = glm::dvec2(seen - eyes_mm_[i]);
  }
  if (!open[0] && !open[1]) {
    record.blink = true;
    return record;
  }
  glm::dvec2 offset_mm = 0.5 * (offset_mm_[0] + offset_mm_[1]);
  if (open[0] && open[1]) {
    const glm::dvec2 apart = offset_mm_[0] - offset_mm_[1];
    apart_mm_ = know_apart_ ? apart_mm_ + kMemory * (apart - apart_mm_) : apart;
    know_apart_ = true;
  } else {
    // What the other eye would say.
    const std::size_t eye = open[0] ? 0 : 1;
    offset_mm = offset_mm_[eye] + (open[0] ? -0.5 : 0.5) * apart_mm_;
  }

  // To the screen's axes: x and y turn round, z points back.
  const glm::dvec3 forward = -pose.camera_from_head[2];
  const glm::dvec3 across = pose.camera_from_head[0];
  WebcamView view;
  view.head_m = glm::dvec3(-pose.position_mm.x, -pose.position_mm.y, pose.position_mm.z) / 1000.0;
  view.head_rad = {std::atan2(-forward.x, -forward.z), std::atan2(-forward.y, -forward.z)};
  view.roll_rad = -std::atan2(across.y, across.x);
  const glm::dvec2 eye = -offset_mm / kEyeWidth_mm;
  const double c = std::cos(view.roll_rad), s = std::sin(view.roll_rad);
  view.eye = {c * eye.x - s * eye.y, s * eye.x + c * eye.y};
  record.view = view;
  double sum = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (record.irises[i]) sum += 0.5 * quality(*record.irises[i], usual_contrast_[i]);
  }
  record.confidence = std::clamp(std::min(1.0, 1.3 * sum) * std::min(1.0, 1.25 * rigid), 0.0, 1.0);
  return record;
}

}  // namespace foci
