#include <cmath>
#include <utility>

#include "app/study/inputs.h"
#include "base/quantile.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

std::vector<TrackedPose> posesOf(const GazeTrace& trace, const SceneAlignment& alignment) {
  const glm::dquat scene_from_world = sceneFromRecording(alignment);
  const glm::dvec3 eye_head_m = middleOfEyes_m(trace.samples);
  const double start_s = trace.samples.front().time_s;
  std::vector<TrackedPose> poses;
  for (const GazeSample& sample : trace.samples) {
    if (!sample.head) continue;
    const HeadInWorld& head = *sample.head;
    const glm::dvec3 eye_world_m = head.position_m + head.world_from_head * eye_head_m;
    poses.push_back(
        {.time_s = sample.time_s - start_s,
         .position_m = alignment.offset_m + alignment.scale * (scene_from_world * eye_world_m),
         .world_from_eye = glm::normalize(scene_from_world * head.world_from_head)});
  }
  return poses;
}

/// The median distance between the recorded origins of both eyes.
std::optional<double> recordedIpd_mm(const GazeTrace& trace) {
  std::vector<double> apart_mm;
  for (const GazeSample& sample : trace.samples) {
    const auto &left = sample.eyes[0].origin_m, &right = sample.eyes[1].origin_m;
    if (sample.head && left && right) apart_mm.push_back(1000.0 * glm::distance(*left, *right));
  }
  if (apart_mm.empty()) return std::nullopt;
  return quantile(apart_mm, 0.5);
}

}  // namespace

bool recordsHead(const Study& study) {
  if (study.gazeIsSimulated() || webcamPlaceOf(study.gaze.source)) return false;
  return previewSpace(study.gaze.source, study.gaze.columns).has_head;
}

glm::dquat sceneFromRecording(const SceneAlignment& alignment) {
  const glm::dvec4& r = alignment.rotation;
  return glm::normalize(glm::dquat(r.w, r.x, r.y, r.z));
}

Study withRecordedHead(Study study, const GazeTrace& trace) {
  std::vector<TrackedPose> poses = posesOf(trace, study.gaze.alignment);
  if (!poses.empty()) study.eye.recorded = EyePath(std::move(poses));
  if (study.screen.is_default && trace.field) {
    study.display.kind = DisplayKind::headset;
    const EyeField& field = *trace.field;
    study.display.field_deg = {field.left_deg, field.right_deg, field.up_deg, field.down_deg};
  }
  return study;
}

std::vector<std::string> headRemarks(const Study& study, const GazeTrace& trace) {
  std::vector<std::string> remarks;
  constexpr double kSameIpd_mm = 1.5;
  const auto ipd_mm = recordedIpd_mm(trace);
  if (ipd_mm && std::abs(*ipd_mm - study.observer.ipd_mm) > kSameIpd_mm &&
      study.output.view != StereoView::mono) {
    remarks.push_back("the recorded eyes are " + significant(*ipd_mm, 3) +
                      " mm apart, and observer.ipd_mm = " + significant(study.observer.ipd_mm) +
                      ": set observer.ipd_mm = " + significant(*ipd_mm, 3));
  }
  if (!trace.scene_scale_m || !study.scene.file) return remarks;
  constexpr double kSame = 0.01;
  const double ratio = study.scene.scale_m / *trace.scene_scale_m;
  if (std::abs(ratio - 1.0) > kSame) {
    remarks.push_back(
        "the recording says that a unit of its scene is " + significant(*trace.scene_scale_m) +
        " m, and scene.scale_m = " + significant(study.scene.scale_m) +
        ": set scene.scale_m = " + significant(*trace.scene_scale_m, 6) + " if this is that scene");
  }
  return remarks;
}

}  // namespace foci
