#include "gaze/webcam/network_tracker.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "gaze/webcam/mesh_pose.h"

namespace foci {
namespace {

// Chosen by hand. The tests on rendered faces bound them.
constexpr double kMinMeshScore = 0.5;
constexpr double kMaxTurn = 0.64;  // cosine of 50 degrees: beyond, an eye is hidden
constexpr int kCountEvery = 30;    // frames, to count the faces while one is followed
constexpr int kPatience = 12;      // frames without eyes, longer than a blink
constexpr double kMinSize = 0.5;   // of another face, over the largest
constexpr int kShapeFrames = 30;   // that the shape of a face is averaged over
constexpr double kOpening = 0.22;  // of an eye whose usual opening is not known yet
constexpr double kBlink = 0.72;    // mean opening of both eyes over the usual one: a blink
constexpr double kHidden = 0.6;    // the same for one eye
constexpr double kRise = 0.2, kFall = 0.01;  // weight of a frame in the usual opening
// Iris diameters between the two runs of the network: up to the first all irises were right, beyond
// the second none.
constexpr double kSure = 0.2, kWrong = 0.45, kMaxDisagreement = 0.3;
constexpr double kGlint = 240.0, kGlintShare = 0.25;

double irisConfidence(double disagreement) {
  return std::clamp((kWrong - disagreement) / (kWrong - kSure), 0.0, 1.0);
}

/// The corners of an eye at the image's left and right. Index 0 is the observer's left eye, at the
/// image's right.
std::pair<glm::dvec2, glm::dvec2> cornersOf(const FaceMesh& mesh, std::size_t eye) {
  const std::size_t left = eye == 0 ? 2 : 0;
  return {mesh.at_px(FaceMesh::kEyeCorners[left]), mesh.at_px(FaceMesh::kEyeCorners[left + 1])};
}

bool inside(const cv::Mat& image, const glm::dvec2& px) {
  return px.x >= 0.0 && px.y >= 0.0 && px.x < image.cols && px.y < image.rows;
}

/// Whether light saturates a good part of the iris.
bool isCovered(const cv::Mat& image, const EyeInImage& eye) {
  const int reach = std::max(1, static_cast<int>(0.7 * eye.radius_px));
  const cv::Point centre(static_cast<int>(eye.centre_px.x), static_cast<int>(eye.centre_px.y));
  const cv::Rect part = cv::Rect(centre.x - reach, centre.y - reach, 2 * reach + 1, 2 * reach + 1) &
                        cv::Rect(0, 0, image.cols, image.rows);
  if (part.empty()) return false;
  cv::Mat grey;
  cv::cvtColor(image(part), grey, cv::COLOR_BGR2GRAY);
  return cv::countNonZero(grey > kGlint) > kGlintShare * part.area();
}

}  // namespace

NetworkTracker::NetworkTracker(FaceNetworks networks, const Lens& camera,
                               const std::optional<WebcamReference>& reference)
    : networks_(std::move(networks)), camera_(camera) {
  if (!reference) return;
  assert(std::holds_alternative<FaceShape>(reference->head));
  shape_ = std::get<FaceShape>(reference->head);
  shape_frames_ = kShapeFrames;
}

std::optional<WebcamReference> NetworkTracker::reference() const {
  if (shape_.empty()) return std::nullopt;
  WebcamReference reference{camera_, shape_, {}};
  // The eyes at rest look ahead, midway between their corners, the first four points of the shape.
  const auto rest = [&](std::size_t outer, std::size_t inner) {
    return glm::dvec3(0.5 * glm::dvec2(shape_[outer] + shape_[inner]), kIrisDepth_mm);
  };
  reference.eyes_mm = {rest(1, 3), rest(0, 2)};
  return reference;
}

/// Whether this is a face whose eyes are in view.
bool NetworkTracker::accept(const cv::Mat& image, const FaceMesh& mesh) const {
  if (!(mesh.score > kMinMeshScore)) return false;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto [left_px, right_px] = cornersOf(mesh, eye);
    if (!inside(image, 0.5 * (left_px + right_px))) return false;
  }
  const auto seen = poseOfMesh(camera_, mesh);
  return seen && seen->pose.camera_from_head[2].z > kMaxTurn;
}

/// Whether both irises are seen.
bool NetworkTracker::showsEyes(const cv::Mat& image, const FaceMesh& mesh) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto [left_px, right_px] = cornersOf(mesh, eye);
    if (networks_.eye(image, left_px, right_px).disagreement >= kMaxDisagreement) return false;
  }
  return true;
}

/// Searches the whole image, and counts its faces. Follows the largest one, unless one is followed
/// already. If that one hides its eyes, a face of at least half its size that shows them is better.
void NetworkTracker::search(const cv::Mat& image) {
  frames_since_search_ = 0;
  faces_ = 0;
  std::vector<FaceMesh> meshes;
  std::vector<double> sides_px;
  for (const FaceBox& box : networks_.detect(image)) {
    FaceMesh mesh = networks_.mesh(image, box);
    if (!(mesh.score > kMinMeshScore)) continue;
    ++faces_;
    if (!accept(image, mesh)) continue;
    meshes.push_back(std::move(mesh));
    sides_px.push_back(box.side_px());
  }
  if (meshes.empty() || (mesh_ && !eyesAreGone())) return;
  for (std::size_t i = 0; i < meshes.size() && sides_px[i] >= kMinSize * sides_px[0]; ++i) {
    if (!(mesh_ || meshes.size() > 1) || !showsEyes(image, meshes[i])) continue;
    begin(std::move(meshes[i]));
    return;
  }
  if (!mesh_) begin(std::move(meshes.front()));
}

void NetworkTracker::begin(FaceMesh mesh) {
  mesh_ = std::move(mesh);
  new_face_ = true;
  showed_eyes_ = false;
  frames_without_eyes_ = 0;
}

/// Whether the face has hidden its eyes for longer than a blink, or has not shown them yet.
bool NetworkTracker::eyesAreGone() const {
  return frames_without_eyes_ >= (showed_eyes_ ? kPatience : 1);
}

/// Fits the pose of the face's shape to the mesh.
bool NetworkTracker::updatePose() {
  const auto seen = poseOfMesh(camera_, *mesh_);
  if (!seen) return false;
  if (shape_frames_ < kShapeFrames) {
    ++shape_frames_;
    if (shape_.empty()) shape_ = seen->shape;
    for (std::size_t i = 0; i < shape_.size(); ++i) {
      shape_[i] += (seen->shape[i] - shape_[i]) / static_cast<double>(shape_frames_);
    }
  }
  const std::vector<glm::dvec2> points_px = rigidPoints_px(*mesh_);
  const std::vector<double> weights(points_px.size(), 1.0);
  const auto fit = fitHeadPose(camera_, shape_, points_px, weights, new_face_ ? seen->pose : pose_);
  new_face_ = !fit;
  pose_ = fit ? fit->pose : seen->pose;
  return true;
}

/// Reads open eyes, and their offsets in the head's frame.
void NetworkTracker::readEyes(const cv::Mat& image, WebcamRecord& record) {
  std::array<EyeInImage, 2> eyes;
  double openings = 0.0;
  std::array<double, 2> opening{};  // over the usual one
  std::array<bool, 2> sure{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto [left_px, right_px] = cornersOf(*mesh_, i);
    eyes[i] = networks_.eye(image, left_px, right_px);
    record.lids_px[i].assign(eyes[i].lids_px.begin(), eyes[i].lids_px.end());
    std::reverse(record.lids_px[i].begin() + 9, record.lids_px[i].end());
    sure[i] = eyes[i].disagreement < kMaxDisagreement;
    const double usual = usual_opening_[i] > 0.0 ? usual_opening_[i] : kOpening;
    opening[i] = eyes[i].opening / usual;
    openings += 0.5 * opening[i];
  }
  const bool known = usual_opening_[0] > 0.0 && usual_opening_[1] > 0.0;
  record.blink = (!sure[0] && !sure[1]) || (known && openings < kBlink);
  if (record.blink) return;

  const auto reference = this->reference();
  std::array<glm::dvec2, 2> offset_mm{};
  std::array<bool, 2> seen{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!sure[i] || (known && opening[i] < kHidden)) continue;
    seen[i] = true;
    const double confidence = irisConfidence(eyes[i].disagreement);
    record.irises[i] = Iris{eyes[i].centre_px, eyes[i].radius_px, 0.0, confidence};
    record.confidence += 0.5 * confidence;
    const glm::dvec3& rest = reference->eyes_mm[i];
    offset_mm[i] = glm::dvec2(onHeadPlane_mm(camera_, pose_, eyes[i].centre_px, rest.z) - rest);
    double& usual = usual_opening_[i];
    const double weight = usual == 0.0 ? 1.0 : eyes[i].opening > usual ? kRise : kFall;
    usual += weight * (eyes[i].opening - usual);
    if (isCovered(image, eyes[i])) record.problem = WebcamProblem::glints;
  }
  if (!seen[0] && !seen[1]) {
    record.blink = true;
    return;
  }
  record.view = webcamView(pose_, mean_offset_.of(offset_mm, seen));
  if (record.problem != WebcamProblem::none) return;
  const double iris_px = 2.0 * kLimbus_mm * camera_.focal_px.x / pose_.position_mm.z;
  record.problem = !seen[0] || !seen[1]    ? WebcamProblem::one_eye_hidden
                   : iris_px < kMinIris_px ? WebcamProblem::too_far
                   : faces_ > 1            ? WebcamProblem::several_faces
                                           : WebcamProblem::none;
}

WebcamRecord NetworkTracker::push(const cv::Mat& image) {
  WebcamRecord record;
  if (mesh_) {
    mesh_ = networks_.mesh(image, mesh_->crop());
    if (!accept(image, *mesh_)) mesh_.reset();
  }
  ++frames_since_search_;
  if (!mesh_ || eyesAreGone() || frames_since_search_ >= kCountEvery) search(image);
  record.faces = faces_;
  if (!mesh_ || !updatePose()) {
    mesh_.reset();
    mean_offset_.forget();
    usual_opening_ = {};
    const cv::Scalar level = cv::mean(image);
    const bool dark = (level[0] + level[1] + level[2]) / 3.0 < kDark;
    record.problem = dark ? WebcamProblem::too_dark : WebcamProblem::no_face;
    return record;
  }
  record.face = true;
  record.head = pose_;
  record.eyes_px = project(camera_, pose_, glm::dvec3(0.0, 0.0, kIrisDepth_mm));
  record.ipd_px = kMeanIpd_mm * camera_.focal_px.x / pose_.position_mm.z;
  readEyes(image, record);
  showed_eyes_ = showed_eyes_ || (record.irises[0] && record.irises[1]);
  const bool gone = showed_eyes_ ? record.blink : true;
  frames_without_eyes_ = gone ? frames_without_eyes_ + 1 : 0;
  return record;
}

}  // namespace foci
