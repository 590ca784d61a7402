#include "gaze/webcam/cascade_tracker.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <tuple>
#include <vector>

#include "base/input_error.h"
#include "base/transformed.h"

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

// Constants were chosen by hand. FaceFinder's tests on rendered faces bound them.
constexpr double kSearchWidth_px = 320.0;  // enough for a face an eighth of the image wide
// The eyes of an average face within the cascade's square, as shares of its side: their place, the
// distance between them, how far around to search, and the radius of the iris.
constexpr double kEyesDown = 0.39, kEyesAside = 0.18, kEyesApart = 0.36, kEyesReach = 0.15;
constexpr double kIrisRadius = 0.034;
constexpr std::size_t kMaxCandidates = 6;

struct Candidate {
  glm::dvec2 centre_px{0.0};
  double score = 0.0;
};

cv::CascadeClassifier cascadeNamed(const std::string& name) {
  for (const char* folder : {"/usr/share/opencv4/haarcascades/", "/usr/share/opencv/haarcascades/",
                             "/usr/local/share/opencv4/haarcascades/"}) {
    const std::filesystem::path file = folder + name;
    cv::CascadeClassifier cascade;
    if (std::filesystem::exists(file) && cascade.load(file.string())) return cascade;
  }
  throw InputError(name, "the cascade that finds faces is not installed: package opencv-data");
}

/// Candidates for an iris. Their score is higher where a cascade sees an eye.
/// @param box      of the face, px
/// @param side     0: the observer's left eye
/// @param seen_px  eyes that the cascades see
std::vector<Candidate> irisesOf(const cv::Mat& grey, const cv::Rect2d& box, int side,
                                const std::vector<glm::dvec2>& seen_px) {
  const glm::dvec2 usual(box.x + (side == 0 ? 0.5 + kEyesAside : 0.5 - kEyesAside) * box.width,
                         box.y + kEyesDown * box.height);
  const double radius = kIrisRadius * box.width;
  std::vector<Candidate> candidates;
  for (const IrisCandidate& coarse :
       coarseIrises(grey, usual, glm::dvec2(kEyesReach * box.width), radius, kMaxCandidates)) {
    Candidate candidate{coarse.centre_px, 0.3 * coarse.score};
    if (const auto iris = refineIris(grey, coarse.centre_px, radius)) {
      constexpr double kClear = 30.0;  // contrast of a clear iris, grey levels
      candidate.centre_px = iris->centre_px;
      candidate.score += iris->confidence * std::min(1.0, iris->contrast / kClear);
    }
    const bool is_seen = std::ranges::any_of(seen_px, [&](const glm::dvec2& seen) {
      return glm::distance(seen, candidate.centre_px) < 0.07 * box.width;
    });
    if (is_seen) candidate.score += 0.4;
    candidates.push_back(candidate);
  }
  return candidates;
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
  const auto eyes_px = finder_.find(grey);
  if (!eyes_px) return false;
  if (given_) {
    head_.start(given_->head);
    eyes_mm_ = given_->eyes_mm;
    given_.reset();
  }
  const HeadPose frontal = HeadTracker::frontal(camera_, *eyes_px);
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
    eyes_mm_[i] = onHeadPlane_mm(camera_, head_.pose(), (*eyes_px)[i], kIrisDepth_mm);
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

struct FaceFinder::Cascades {
  cv::CascadeClassifier face = cascadeNamed("haarcascade_frontalface_alt2.xml");
  cv::CascadeClassifier face_more = cascadeNamed("haarcascade_frontalface_default.xml");
  cv::CascadeClassifier eye = cascadeNamed("haarcascade_eye.xml");
  cv::CascadeClassifier eye_glasses = cascadeNamed("haarcascade_eye_tree_eyeglasses.xml");

  /// Squares around possible faces, px: up to four, the largest first.
  std::vector<cv::Rect2d> faces(const cv::Mat& grey) {
    const double scale = std::max(1.0, grey.cols / kSearchWidth_px);
    cv::Mat small;
    cv::resize(grey, small, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
    const int min_side = small.cols / 8;
    std::vector<cv::Rect> found, more;
    face.detectMultiScale(small, found, 1.1, 3, 0, {min_side, min_side});
    face_more.detectMultiScale(small, more, 1.1, 4, 0, {min_side, min_side});
    found.insert(found.end(), more.begin(), more.end());
    // The cascades' order depends on their threads. This order does not.
    std::ranges::sort(found, [](const cv::Rect& a, const cv::Rect& b) {
      return std::tuple(a.width, a.y, a.x) > std::tuple(b.width, b.y, b.x);
    });
    constexpr std::size_t kMaxFaces = 4;
    if (found.size() > kMaxFaces) found.resize(kMaxFaces);
    return transformed(found, [&](const cv::Rect& box) {
      return cv::Rect2d(box.x * scale, box.y * scale, box.width * scale, box.height * scale);
    });
  }

  /// Centres of possible eyes in the upper part of a face, px.
  std::vector<glm::dvec2> eyesIn(const cv::Mat& grey, const cv::Rect2d& face_px) {
    const cv::Rect upper = cv::Rect(cvRound(face_px.x), cvRound(face_px.y + 0.1 * face_px.height),
                                    cvRound(face_px.width), cvRound(0.5 * face_px.height)) &
                           cv::Rect({0, 0}, grey.size());
    constexpr double kUsualWidth_px = 160.0;
    const double shrink = std::max(1.0, upper.width / kUsualWidth_px);
    cv::Mat search;
    cv::resize(grey(upper), search, {}, 1.0 / shrink, 1.0 / shrink, cv::INTER_AREA);
    const int min_side = search.cols / 7;
    std::vector<glm::dvec2> centres;
    for (cv::CascadeClassifier* cascade : {&eye, &eye_glasses}) {
      std::vector<cv::Rect> eyes;
      cascade->detectMultiScale(search, eyes, 1.1, 2, 0, {min_side, min_side});
      for (const cv::Rect& found : eyes) {
        const glm::dvec2 at(found.x + 0.5 * found.width, found.y + 0.5 * found.height);
        centres.push_back(glm::dvec2(upper.x, upper.y) + shrink * at);
      }
    }
    return centres;
  }
};

FaceFinder::FaceFinder() : cascades_(std::make_unique<Cascades>()) {}
FaceFinder::~FaceFinder() = default;
FaceFinder::FaceFinder(FaceFinder&& other) noexcept = default;

std::optional<std::array<glm::dvec2, 2>> FaceFinder::find(const cv::Mat& grey) {
  // Of all pairs of irises, take the one that suits a face best.
  double best = 0.0;
  std::array<glm::dvec2, 2> eyes_px{};
  for (const cv::Rect2d& box : cascades_->faces(grey)) {
    const std::vector<glm::dvec2> seen_px = cascades_->eyesIn(grey, box);
    const std::vector<Candidate> lefts = irisesOf(grey, box, 0, seen_px);
    const std::vector<Candidate> rights = irisesOf(grey, box, 1, seen_px);
    for (const Candidate& left : lefts) {
      for (const Candidate& right : rights) {
        const glm::dvec2 between = left.centre_px - right.centre_px;
        const double apart = glm::length(between) / (kEyesApart * box.width) - 1.0;
        const double roll = std::atan2(between.y, between.x);
        const double suits =
            std::exp(-0.5 * std::pow(apart / 0.15, 2) - 0.5 * std::pow(roll / 0.2, 2));
        const double score = (left.score + right.score) * suits;
        if (score > best) {
          best = score;
          eyes_px = {left.centre_px, right.centre_px};
        }
      }
    }
  }
  return best > 0.0 ? std::optional(eyes_px) : std::nullopt;
}

}  // namespace foci
