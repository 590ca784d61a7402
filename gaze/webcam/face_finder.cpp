#include "gaze/webcam/face_finder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <tuple>
#include <vector>

#include "base/input_error.h"
#include "gaze/webcam/iris.h"

namespace foci {
namespace {

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
    const bool is_seen = std::any_of(seen_px.begin(), seen_px.end(), [&](const glm::dvec2& seen) {
      return glm::distance(seen, candidate.centre_px) < 0.07 * box.width;
    });
    if (is_seen) candidate.score += 0.4;
    candidates.push_back(candidate);
  }
  return candidates;
}

}  // namespace

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
    std::sort(found.begin(), found.end(), [](const cv::Rect& a, const cv::Rect& b) {
      return std::tuple(a.width, a.y, a.x) > std::tuple(b.width, b.y, b.x);
    });
    constexpr std::size_t kMaxFaces = 4;
    if (found.size() > kMaxFaces) found.resize(kMaxFaces);
    std::vector<cv::Rect2d> boxes;
    boxes.reserve(found.size());
    for (const cv::Rect& box : found) {
      boxes.emplace_back(box.x * scale, box.y * scale, box.width * scale, box.height * scale);
    }
    return boxes;
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

std::optional<FoundFace> FaceFinder::find(const cv::Mat& grey) {
  // Of all pairs of irises, take the one that suits a face best.
  double best = 0.0;
  FoundFace face;
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
          face.eyes_px = {left.centre_px, right.centre_px};
        }
      }
    }
  }
  return best > 0.0 ? std::optional(face) : std::nullopt;
}

}  // namespace foci
