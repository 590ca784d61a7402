#include "app/live/outside.h"

#include <algorithm>
#include <glm/gtc/constants.hpp>

#include "app/record/gaze_marker.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

// Chosen by hand.
constexpr std::size_t kMaxPath = 4000, kMaxFixations = 200;
constexpr double kStep_m = 0.002;       // of the path
constexpr double kSameFixation = 0.05;  // of the distance: 3 degrees
constexpr double kMaxSight_m = 20.0;    // of a line of sight that meets no surface
constexpr double kField_deg = 55.0;     // of the camera
constexpr float kNear = 0.3f;           // of its distance: walls that are nearer are cut away

template <class T>
void pushLatest(std::deque<T>& values, const T& value, std::size_t max) {
  if (values.size() == max) values.pop_front();
  values.push_back(value);
}

}  // namespace

void ObserverTrail::add(const FrameRecord& record, const Screen& screen) {
  if (path_m_.empty() || glm::distance(path_m_.back(), record.eye_m) > kStep_m) {
    pushLatest(path_m_, record.eye_m, kMaxPath);
  }
  const bool fixated = std::exchange(fixates_, false);
  const bool fixates = isFixating(record);
  const auto& point_px = fixates ? record.fixation_px : record.gaze_px;
  looks_at_m_.reset();
  if (!point_px) return;
  const auto surface_m = fixates ? record.eye.surface_distance_m : std::nullopt;
  const double away_m = surface_m.value_or(1.0 / std::max(record.eye.focus_D, 1.0 / kMaxSight_m));
  looks_at_m_ = record.eye_m + record.world_from_eye * (away_m * lineOfSight(screen, *point_px));
  if (!surface_m) return;
  fixates_ = true;
  const bool goes_on =
      fixated && glm::distance(fixations_.back().point_m, *looks_at_m_) < kSameFixation * away_m;
  if (!goes_on) pushLatest(fixations_, {.from_s = record.time_s}, kMaxFixations);
  Fixation& fixation = fixations_.back();
  fixation.to_s = record.time_s;
  fixation.point_m += (*looks_at_m_ - fixation.point_m) / static_cast<double>(++fixation.frames);
}

std::optional<std::pair<glm::vec2, glm::vec2>> lineInView_px(const View& view, glm::dvec3 from_m,
                                                             glm::dvec3 to_m) {
  const auto inEye = [&](const glm::dvec3& point_m) {
    return glm::dvec3(glm::dmat4(view.eye_from_world) * glm::dvec4(point_m, 1.0));
  };
  constexpr double kNear_m = 1e-3;
  glm::dvec3 from = inEye(from_m), to = inEye(to_m);
  if (from.z > -kNear_m && to.z > -kNear_m) return std::nullopt;
  const auto cut = [&](glm::dvec3& end, const glm::dvec3& other) {
    if (end.z > -kNear_m) end = glm::mix(other, end, (-kNear_m - other.z) / (end.z - other.z));
  };
  cut(from, to);
  cut(to, from);
  return std::pair(project(view, glm::vec3(from)), project(view, glm::vec3(to)));
}

LivePose cameraBehind(const FrameRecord& record, const glm::dvec3& up) {
  constexpr double kMin_m = 1.0;
  const double focus_m = 1.0 / std::max(record.eye.focus_D, 1.0 / kMaxSight_m);
  const double away_m = std::max(kMin_m, record.eye.surface_distance_m.value_or(focus_m));
  // The small part keeps it from being zero if the head lies on its side.
  glm::dvec3 right = record.world_from_eye * glm::dvec3(1.0, 0.0, 1e-3);
  right = glm::normalize(right - glm::dot(right, up) * up);
  const glm::dvec3 forwards = glm::cross(up, right);
  return LivePose(record.eye_m + away_m * (0.6 * right + 0.5 * up - 0.7 * forwards),
                  record.eye_m + 0.5 * away_m * forwards, up);
}

OutsideView::OutsideView(OutsideScene&& scene, const LivePose& camera)
    : camera_(camera),
      request_(std::move(scene.request)),
      refiner_(std::move(scene.renderer), scene.threads) {}

void OutsideView::update(const glm::ivec2& size_px) {
  if (asked_) {
    auto rendered = refiner_.take(request_);
    if (!rendered) return;  // a newer request would cancel it
    asked_ = false;
    view_ = request_.eyes[0].eye.view;
    image_ = std::make_shared<const Image>(imageOf(rendered->frame));
    refiner_.reuse(std::move(*rendered));
  }
  const LivePose& pose = camera_.pose();
  View view = viewOfCamera(eyeFromWorld(pose.position_m(), pose.look_at_m(), pose.up()), size_px,
                           glm::radians(kField_deg));
  view.near_m = kNear * static_cast<float>(pose.away_m());
  if (image_ && view == view_) return;
  request_.size_px = size_px;
  request_.eyes[0].eye = {.view = view};
  refiner_.want({request_});
  asked_ = true;
}

}  // namespace foci
