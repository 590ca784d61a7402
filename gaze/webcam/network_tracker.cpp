#include "gaze/webcam/network_tracker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace foci {
namespace {

// Chosen by hand. The tests on rendered faces bound them.
constexpr double kMinMeshScore = 0.5;
constexpr double kMaxTurn = 0.64;      // cosine of 50 degrees: beyond, an eye is hidden
constexpr int kCountEvery = 30;        // frames, to count the faces while one is followed
constexpr double kMoved = 0.03;        // `motion` that makes a mesh less exact
constexpr int kSeekEvery = 6;          // frames, to seek a face that shows its eyes
constexpr double kSameFace = 0.5;      // between the middles of the eyes, over the face's side
constexpr int kPatience = 12;          // frames without eyes, longer than a blink
constexpr double kMinSize = 0.5;       // of another face, over the largest
constexpr int kCompared = 100;         // frames, to compare the mesh's pose with the patches'
constexpr double kMaxApart_rad = 0.2;  // between these two poses: the patches are not the face's
constexpr int kMaxMisses = 5;          // then the head is another, or in another light
constexpr double kOpening = 0.22;      // of an eye whose usual opening is not known yet
constexpr double kBlink = 0.72;        // mean opening of both eyes over the usual one: a blink
constexpr double kHidden = 0.6;        // the same for one eye
constexpr double kRise = 0.2, kFall = 0.01;  // weight of a frame in the usual opening
// Between the two runs of the network, iris diameters: beyond, every fifth iris is wrong.
constexpr double kMaxDisagreement = 0.3;
constexpr double kGlint = 240.0, kGlintShare = 0.25;

/// Share of right irises among those of this disagreement. The curve is that of the largest
/// likelihood on photographs of faces that were made smaller, darker, noisy, blurred or partly
/// covered. On faces that its fit had left out it holds within 0.05 (docs/results.md#the-webcam).
double irisConfidence(double disagreement) {
  return 0.98 / (1.0 + std::pow(disagreement / 0.6, 2.25));
}

bool inside(const cv::Mat& image, const glm::dvec2& px) {
  return px.x >= 0.0 && px.y >= 0.0 && px.x < image.cols && px.y < image.rows;
}

glm::dvec3 middleOfEyes_px(const FaceMesh& mesh) {
  glm::dvec3 sum(0.0);
  for (const std::size_t corner : FaceMesh::kEyeCorners) sum += mesh.points[corner];
  return 0.25 * sum;
}

/// How far a face moved, in sides of its crop, or turned, in radians; the largest of these.
double motion(const Crop& from, const Crop& to) {
  return std::max(
      {glm::distance(from.centre_px, to.centre_px) / from.side_px,
       std::abs(to.side_px / from.side_px - 1.0),
       std::abs(std::remainder(to.angle_rad - from.angle_rad, 2.0 * std::numbers::pi))});
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

/// Pairs of points that neither expression nor gaze moves much. They mirror each other, at the
/// image's left and right of a face that looks ahead.
constexpr std::array<std::size_t, 16> kLefts{33, 133, 127, 234, 34,  21,  54,  103,
                                             67, 109, 116, 117, 111, 122, 193, 198};
constexpr std::array<std::size_t, 16> kRights{263, 362, 356, 454, 264, 251, 284, 332,
                                              297, 338, 345, 346, 340, 351, 417, 420};

/// The line from the forehead (10) to the base of the nose (2) leans forwards by about this angle
/// in a face that looks ahead. It differs between people by some 0.1 rad, which a calibration
/// removes.
constexpr double kProfile_rad = 0.12;

/// Place of the eyes' corners in the head frame: behind the iris of an eye at rest.
constexpr double kCornerDepth_mm = -5.0;

/// A mesh sees the head along the ray to it. Turns that ray's frame to the camera's, by the
/// shortest way.
glm::dmat3 turnTowards(const glm::dvec2& aside) {
  const glm::dvec3 z = glm::normalize(glm::dvec3(aside, 1.0));
  const glm::dvec3 x =
      glm::dvec3(1.0, 0.0, 0.0) - z.x / (1.0 + z.z) * glm::dvec3(z.x, z.y, z.z + 1.0);
  return {x, glm::cross(z, x), z};
}

/// The pose of a head from one mesh of its face. It has no drift and needs no earlier frame, but it
/// errs by a degree or two, which differ with pose and expression. As if the mesh's depth were
/// right, seen along the ray to the head (weak perspective). The head's axes follow the symmetry of
/// the face and its profile from forehead to nose. Absent if the mesh has no extent.
std::optional<HeadPose> poseOfMesh(const Pinhole& camera, const FaceMesh& mesh) {
  const auto& corner = FaceMesh::kEyeCorners;
  const glm::dvec3 eyes_px = 0.5 * (mesh.points[corner[2]] + mesh.points[corner[3]] -
                                    mesh.points[corner[0]] - mesh.points[corner[1]]);
  const double px_per_mm = glm::length(eyes_px) / kMeanIpd_mm;
  if (!(px_per_mm > 0.01)) return std::nullopt;
  glm::dvec3 across(0.0);
  for (std::size_t i = 0; i < kLefts.size(); ++i) {
    across += mesh.points[kRights[i]] - mesh.points[kLefts[i]];
  }
  const glm::dvec3 x = glm::normalize(across);
  glm::dvec3 down = mesh.points[2] - mesh.points[10];
  down = glm::normalize(down - glm::dot(down, x) * x);
  const glm::dvec3 into = glm::cross(x, down);
  const glm::dvec3 y = std::cos(kProfile_rad) * down + std::sin(kProfile_rad) * into;
  const glm::dvec3 middle = middleOfEyes_px(mesh);
  const glm::dvec2 aside = (glm::dvec2(middle) - camera.principal_px) / camera.focal_px;
  HeadPose pose;
  pose.camera_from_head = turnTowards(aside) * glm::dmat3(x, y, glm::cross(x, y));
  if (!std::isfinite(glm::determinant(pose.camera_from_head))) return std::nullopt;
  pose.position_mm = camera.focal_px.x / px_per_mm * glm::dvec3(aside, 1.0) -
                     pose.camera_from_head * glm::dvec3(0.0, 0.0, kCornerDepth_mm);
  return pose;
}

}  // namespace

NetworkTracker::NetworkTracker(FaceNetworks networks, const Lens& camera,
                               const std::optional<WebcamReference>& reference)
    : networks_(std::move(networks)), camera_(camera), head_(camera) {
  if (!reference) return;
  head_.start(reference->head);
  eyes_mm_ = reference->eyes_mm;
}

std::optional<WebcamReference> NetworkTracker::reference() const {
  if (!head_.started()) return std::nullopt;
  return WebcamReference{camera_, head_.firstView(), eyes_mm_, true};
}

/// Whether this is a face whose eyes are in view.
bool NetworkTracker::accept(const cv::Mat& image, const FaceMesh& mesh) const {
  if (!(mesh.score > kMinMeshScore)) return false;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto [left_px, right_px] = mesh.corners_px(eye);
    if (!inside(image, 0.5 * (left_px + right_px))) return false;
  }
  const auto seen = poseOfMesh(camera_, mesh);
  return seen && seen->camera_from_head[2].z > kMaxTurn;
}

/// Searches the whole image, and counts its faces. Follows the largest one, unless one is followed
/// already: of one in doubt it finds the mesh anew, since a mesh that lost its face may sit on a
/// mouth for eyes. If that face hides its eyes, one of at least half its size that shows one is
/// better.
/// @param in_doubt  whether a followed face that is not found here may be none
void NetworkTracker::search(const cv::Mat& image, bool in_doubt) {
  frames_since_search_ = 0;
  bool is_gone = eyesAreGone() || in_doubt;
  std::vector<FaceMesh> found;
  std::vector<glm::dvec2> known_px;  // middles of the eyes
  bool found_again = false;          // the followed face
  if (mesh_) known_px.emplace_back(middleOfEyes_px(*mesh_));
  for (const FaceBox& box : networks_.detect(image)) {
    const bool is_known = mesh_ && !is_gone &&
                          glm::distance(0.5 * (box.eyes_px[0] + box.eyes_px[1]), known_px.front()) <
                              0.5 * kSameFace * box.side_px();
    if (is_known) {  // it needs no other mesh
      found_again = true;
      continue;
    }
    FaceMesh mesh = networks_.mesh(image, box);
    if (!(mesh.score > kMinMeshScore)) continue;
    const glm::dvec2 middle_px(middleOfEyes_px(mesh));
    const auto same = std::ranges::find_if(known_px, [&](const glm::dvec2& known) {
      return glm::distance(known, middle_px) < kSameFace * box.side_px();
    });
    const bool followed = mesh_ && same == known_px.begin();
    if (!followed && same != known_px.end()) continue;
    const bool shows_eyes = accept(image, mesh);
    if (followed) {
      found_again = true;
      known_px.front() = middle_px;
      is_gone = eyesAreGone();
      if (shows_eyes) mesh_ = std::move(mesh);
      continue;
    }
    known_px.push_back(middle_px);
    if (shows_eyes) found.push_back(std::move(mesh));
  }
  faces_ = static_cast<int>(known_px.size());
  if (found.empty() || (mesh_ && !is_gone)) return;
  const double largest_px = (mesh_ ? *mesh_ : found.front()).crop().side_px;
  for (FaceMesh& mesh : found) {
    if (!(mesh_ || found.size() > 1) || mesh.crop().side_px < kMinSize * largest_px) continue;
    const auto eyes = networks_.eyes(image, mesh);
    if (std::min(eyes[0].disagreement, eyes[1].disagreement) >= kMaxDisagreement) continue;
    if (mesh_ && !found_again) --faces_;  // it was none
    begin(std::move(mesh));
    return;
  }
  if (!mesh_) begin(std::move(found.front()));
}

void NetworkTracker::begin(FaceMesh mesh) {
  mesh_ = std::move(mesh);
  showed_eyes_ = false;
  frames_without_eyes_ = 0;
}

/// Whether the face has hidden its eyes for longer than a blink, or has not shown them yet.
bool NetworkTracker::eyesAreGone() const {
  return frames_without_eyes_ >= (showed_eyes_ ? kPatience : 1);
}

/// Finds the head's patches, starting at the pose that the mesh shows. Without them the mesh's pose
/// serves, corrected by its usual difference from theirs.
bool NetworkTracker::updatePose(const cv::Mat& grey) {
  const auto seen = poseOfMesh(camera_, *mesh_);
  if (!seen) return false;
  mesh_pose_ = *seen;
  pose_.camera_from_head = mesh_pose_.camera_from_head * glm::transpose(mesh_turn_);
  pose_.position_mm = mesh_pose_.position_mm - mesh_shift_mm_;
  following_ = false;
  if (!head_.started()) return true;
  const auto fit = head_.follow(grey, pose_);
  following_ =
      fit && angleBetween_rad(fit->pose.camera_from_head, pose_.camera_from_head) < kMaxApart_rad;
  if (following_) pose_ = fit->pose;
  return true;
}

/// Of a face with open eyes: a mesh's pose changes when the eyes shut. Compares both poses. Where
/// there are no patches, or they were lost, this frame's serve from now on.
void NetworkTracker::learnPose(const cv::Mat& grey) {
  if (following_) {
    misses_ = 0;
    compared_ = std::min(compared_ + 1, kCompared);
    const double weight = 1.0 / compared_;
    const glm::dmat3 turn = glm::transpose(pose_.camera_from_head) * mesh_pose_.camera_from_head;
    mesh_turn_ = orthonormal((1.0 - weight) * mesh_turn_ + weight * turn);
    mesh_shift_mm_ += weight * (mesh_pose_.position_mm - pose_.position_mm - mesh_shift_mm_);
    return;
  }
  if (head_.started() && ++misses_ < kMaxMisses) return;
  misses_ = 0;
  if (!head_.started()) {
    // The eyes at rest look ahead, midway between their corners.
    for (std::size_t i = 0; i < 2; ++i) {
      const auto [left_px, right_px] = mesh_->corners_px(i);
      eyes_mm_[i] = onHeadPlane_mm(camera_, pose_, 0.5 * (left_px + right_px), kIrisDepth_mm);
    }
  }
  head_.start(grey, pose_);
}

/// Reads open eyes, and their offsets in the head's frame.
void NetworkTracker::readEyes(const cv::Mat& image, const cv::Mat& grey, WebcamRecord& record) {
  const std::array<EyeInImage, 2> eyes = networks_.eyes(image, *mesh_);
  double openings = 0.0;
  std::array<double, 2> opening{};  // over the usual one
  std::array<bool, 2> sure{};
  for (std::size_t i = 0; i < 2; ++i) {
    record.lids_px[i].assign(eyes[i].lids_px.begin(), eyes[i].lids_px.end());
    std::reverse(record.lids_px[i].begin() + 9, record.lids_px[i].end());
    sure[i] = eyes[i].disagreement < kMaxDisagreement;
    if (isCovered(image, eyes[i])) record.problem = WebcamProblem::glints;
    const double usual = usual_opening_[i] > 0.0 ? usual_opening_[i] : kOpening;
    opening[i] = eyes[i].opening / usual;
    openings += 0.5 * opening[i];
  }
  // No blink lasts so long, and of shut eyes the network is not sure.
  if (frames_without_eyes_ >= kPatience && sure[0] && sure[1]) usual_opening_ = {};
  const bool known = usual_opening_[0] > 0.0 && usual_opening_[1] > 0.0;
  const bool shut = (!sure[0] && !sure[1]) || (known && openings < kBlink);
  record.blink = shut && record.problem != WebcamProblem::glints;
  if (shut) return;

  learnPose(grey);
  std::array<glm::dvec2, 2> offset_mm{};
  std::array<bool, 2> seen{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!sure[i] || (known && opening[i] < kHidden)) continue;
    seen[i] = true;
    const double confidence = irisConfidence(eyes[i].disagreement);
    record.irises[i] = Iris{eyes[i].centre_px, eyes[i].radius_px, 0.0, confidence};
    record.confidence += confidence;
    const glm::dvec3& rest = eyes_mm_[i];
    offset_mm[i] = glm::dvec2(onHeadPlane_mm(camera_, pose_, eyes[i].centre_px, rest.z) - rest);
    double& usual = usual_opening_[i];
    const double weight = usual == 0.0 ? 1.0 : eyes[i].opening > usual ? kRise : kFall;
    usual += weight * (eyes[i].opening - usual);
  }
  if (!seen[0] && !seen[1]) {
    record.blink = true;
    return;
  }
  if (seen[0] && seen[1]) record.confidence *= 0.5;
  record.view = webcamView(pose_, mean_offset_.of(offset_mm, seen));
  if (record.problem != WebcamProblem::none) return;
  const double iris_px = 2.0 * kLimbus_mm * camera_.focal_px.x / pose_.position_mm.z;
  record.problem = !seen[0] || !seen[1]    ? WebcamProblem::one_eye_hidden
                   : iris_px < kMinIris_px ? WebcamProblem::too_far
                   : faces_ > 1            ? WebcamProblem::several_faces
                                           : WebcamProblem::none;
}

/// Pose and eyes of the face that the mesh shows.
WebcamRecord NetworkTracker::read(const cv::Mat& image) {
  WebcamRecord record;
  record.faces = faces_;
  cv::Mat grey;
  if (mesh_) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  if (!mesh_ || !updatePose(grey)) {
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
  readEyes(image, grey, record);
  return record;
}

WebcamRecord NetworkTracker::push(const cv::Mat& image) {
  bool jumped = false;
  if (mesh_) {
    // Where the face moved, the mesh is exact in its new crop only. If it does not come to rest
    // there, it may have lost the face.
    for (int run = 0; run == 0 || (run == 1 && jumped); ++run) {
      const Crop crop = mesh_->crop();
      mesh_ = networks_.mesh(image, crop);
      jumped = motion(crop, mesh_->crop()) > kMoved;
    }
    if (!accept(image, *mesh_)) mesh_.reset();
  }
  ++frames_since_search_;
  const bool due = frames_since_search_ >= (eyesAreGone() ? kSeekEvery : kCountEvery);
  if (!mesh_ || jumped || due) search(image, jumped);
  WebcamRecord record = read(image);
  const auto showsBoth = [&] { return record.irises[0] && record.irises[1]; };
  if (mesh_ && shows_both_ && !showsBoth() && frames_since_search_ > 0) {
    // The eyes shut, or the face jumped out of a crop in which the network still sees one.
    const Crop crop = mesh_->crop();
    search(image, true);
    if (motion(crop, mesh_->crop()) > kMoved) record = read(image);
  }
  shows_both_ = showsBoth();
  if (!mesh_) return record;
  showed_eyes_ = showed_eyes_ || shows_both_;
  const bool gone = !showed_eyes_ || !record.view;
  frames_without_eyes_ = gone ? frames_without_eyes_ + 1 : 0;
  return record;
}

}  // namespace foci
