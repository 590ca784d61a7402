#include "gaze/webcam/cascade_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace foci {
namespace {

// How far the iris may be from its place at rest. Eyes turn by up to 30 degrees, and the place at
// rest is a guess.
const glm::dvec2 kReach_mm{8.5, 6.5};

// Chosen by hand. CascadeTracker's tests on rendered faces bound them.
constexpr double kShut = 0.45;  // of the usual contrast: below, the eyelid hides the iris
constexpr double kMinConfidence = 0.2;
constexpr double kMemory = 0.03;       // weight of a frame in the usual values
constexpr double kFoundInliers = 0.5;  // of a head that was just found
constexpr int kSearchEvery = 3;        // frames without a head from one search to the next
constexpr int kMaxFailures = 5;        // then it is another head, or in another light

double quality(const Iris& iris, double usual_contrast) {
  return iris.confidence * std::min(1.0, iris.contrast / std::max(usual_contrast, 20.0));
}

}  // namespace

CascadeTracker::CascadeTracker(const Lens& camera, const std::optional<WebcamReference>& reference)
    : camera_(camera), head_(camera), given_(reference) {
  radius_mm_ = {kLimbus_mm, kLimbus_mm};
}

std::optional<WebcamReference> CascadeTracker::reference() const {
  if (!head_.started()) return std::nullopt;
  return WebcamReference{camera_, head_.firstView(), eyes_mm_, false};
}

bool CascadeTracker::findHead(const cv::Mat& grey) {
  const auto face = finder_.find(grey);
  if (!face) return false;
  if (given_) {
    head_.start(given_->head);
    eyes_mm_ = given_->eyes_mm;
    given_.reset();
  }
  const HeadPose frontal = HeadTracker::frontal(camera_, face->eyes_px);
  if (head_.started() && failures_ < kMaxFailures) {
    if (head_.follow(grey, frontal)) {
      failures_ = 0;
      return true;
    }
    ++failures_;
    return false;
  }
  failures_ = 0;
  head_.start(grey, frontal);
  for (std::size_t i = 0; i < 2; ++i) {
    eyes_mm_[i] = onHeadPlane_mm(camera_, head_.pose(), face->eyes_px[i], kIrisDepth_mm);
    offset_mm_[i] = glm::dvec2(0.0);
    usual_contrast_[i] = 0.0;
    radius_mm_[i] = kLimbus_mm;
  }
  mean_offset_.forget();
  return true;
}

std::optional<Iris> CascadeTracker::findIris(const cv::Mat& grey, std::size_t eye) const {
  const HeadPose& pose = head_.pose();
  const double px_per_mm = camera_.focal_px.x / pose.position_mm.z;
  const double radius_px = radius_mm_[eye] * px_per_mm;
  const glm::dvec2 rest_px = project(camera_, pose, eyes_mm_[eye]);
  constexpr std::size_t kCandidates = 2;
  std::vector<glm::dvec2> places;
  for (const IrisCandidate& candidate :
       coarseIrises(grey, rest_px, kReach_mm * px_per_mm, radius_px, kCandidates)) {
    places.push_back(candidate.centre_px);
  }
  places.push_back(project(camera_, pose, eyes_mm_[eye] + glm::dvec3(offset_mm_[eye], 0.0)));
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

/// Follows the head, or searches for it.
/// @return share of the head's points that agree with its pose; nothing without a head
std::optional<double> CascadeTracker::locateHead(const cv::Mat& grey) {
  double rigid = 0.0;
  if (head_.started()) {
    const auto fit = head_.follow(grey);
    if (!fit && following_) frames_without_head_ = 0;
    following_ = fit.has_value();
    rigid = fit ? fit->inliers : 0.0;
  }
  if (following_) return rigid;
  if (frames_without_head_++ % kSearchEvery != 0 || !findHead(grey)) return std::nullopt;
  following_ = true;
  return kFoundInliers;
}

/// Reads the irises of open eyes, and their offsets in the head's frame.
void CascadeTracker::readIrises(const cv::Mat& grey, WebcamRecord& record) {
  const double px_per_mm = camera_.focal_px.x / head_.pose().position_mm.z;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto iris = findIris(grey, i);
    if (!iris) continue;
    const bool open =
        iris->confidence > kMinConfidence && iris->contrast > kShut * usual_contrast_[i];
    if (!open) continue;
    record.irises[i] = iris;
    const double memory = usual_contrast_[i] > 0.0 ? kMemory : 1.0;
    usual_contrast_[i] += memory * (iris->contrast - usual_contrast_[i]);
    radius_mm_[i] += kMemory * (iris->radius_px / px_per_mm - radius_mm_[i]);
    radius_mm_[i] = std::clamp(radius_mm_[i], 0.85 * kLimbus_mm, 1.15 * kLimbus_mm);
    const glm::dvec3 seen = onHeadPlane_mm(camera_, head_.pose(), iris->centre_px, eyes_mm_[i].z);
    offset_mm_[i] = glm::dvec2(seen - eyes_mm_[i]);
  }
}

WebcamRecord CascadeTracker::push(const cv::Mat& grey) {
  WebcamRecord record;
  const auto rigid = locateHead(grey);
  if (!rigid) {
    record.problem = cv::mean(grey)[0] < kDark ? WebcamProblem::too_dark : WebcamProblem::no_face;
    return record;
  }
  record.face = true;
  record.faces = 1;
  record.head = head_.pose();
  record.eyes_px = project(camera_, head_.pose(), glm::dvec3(0.0, 0.0, kIrisDepth_mm));
  const double px_per_mm = camera_.focal_px.x / head_.pose().position_mm.z;
  record.ipd_px = kMeanIpd_mm * px_per_mm;
  readIrises(grey, record);
  const std::array<bool, 2> seen{record.irises[0].has_value(), record.irises[1].has_value()};
  if (!seen[0] && !seen[1]) {
    record.blink = true;
    return record;
  }
  record.view = webcamView(head_.pose(), mean_offset_.of(offset_mm_, seen));
  double sum = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (seen[i]) sum += 0.5 * quality(*record.irises[i], usual_contrast_[i]);
  }
  record.confidence = std::clamp(std::min(1.0, 1.3 * sum) * std::min(1.0, 1.25 * *rigid), 0.0, 1.0);
  if (!seen[0] || !seen[1]) {
    record.problem = WebcamProblem::one_eye_hidden;
  } else if (2.0 * kLimbus_mm * px_per_mm < kMinIris_px) {
    record.problem = WebcamProblem::too_far;
  }
  return record;
}

}  // namespace foci
