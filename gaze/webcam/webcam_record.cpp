#include "gaze/webcam/webcam_record.h"

#include <cmath>

#include "base/text.h"

namespace foci {

std::string textOf(WebcamProblem problem, double ipd_px) {
  constexpr std::array<const char*, 7> kTexts = {
      "",
      "no face in view: the image is too dark",
      "no face in view",
      "glints cover the iris: move the light or the glasses",
      "one eye is hidden",
      "the face is too far away or the image too small: the iris has ",
      "several faces: the one that was followed, or else the largest, is used"};
  std::string text = kTexts[static_cast<std::size_t>(problem)];
  if (problem != WebcamProblem::too_far) return text;
  return text + decimal(2.0 * kLimbus_mm * ipd_px / kMeanIpd_mm, 1) + " pixels, 8 are needed";
}

void WebcamProblems::add(const WebcamRecord& record) {
  if (record.problem == WebcamProblem::none) return;
  Count& count = counts_[record.problem];
  ++count.frames;
  count.ipd_px += record.ipd_px;
}

std::vector<std::pair<std::size_t, std::string>> WebcamProblems::list() const {
  std::vector<std::pair<std::size_t, std::string>> all;
  for (const auto& [problem, count] : counts_) {
    all.emplace_back(count.frames,
                     textOf(problem, count.ipd_px / static_cast<double>(count.frames)));
  }
  return all;
}

WebcamView webcamView(const HeadPose& pose, const glm::dvec2& offset_mm) {
  const glm::dvec3 forward = -pose.camera_from_head[2];
  const glm::dvec3 across = pose.camera_from_head[0];
  WebcamView view;
  view.head_m = glm::dvec3(-pose.position_mm.x, -pose.position_mm.y, pose.position_mm.z) / 1000.0;
  view.head_rad = {std::atan2(-forward.x, -forward.z), std::atan2(-forward.y, -forward.z)};
  view.roll_rad = -std::atan2(across.y, across.x);
  const glm::dvec2 eye = -offset_mm / kEyeWidth_mm;
  const double c = std::cos(view.roll_rad), s = std::sin(view.roll_rad);
  view.eye = {c * eye.x - s * eye.y, s * eye.x + c * eye.y};
  return view;
}

glm::dvec2 MeanOffset::of(const std::array<glm::dvec2, 2>& offset_mm,
                          const std::array<bool, 2>& seen) {
  constexpr double kMemory = 0.03;  // weight of a frame in the usual difference
  if (seen[0] && seen[1]) {
    const glm::dvec2 apart = offset_mm[0] - offset_mm[1];
    apart_mm_ = apart_mm_ ? *apart_mm_ + kMemory * (apart - *apart_mm_) : apart;
    return 0.5 * (offset_mm[0] + offset_mm[1]);
  }
  const glm::dvec2 half = 0.5 * apart_mm_.value_or(glm::dvec2(0.0));
  return seen[0] ? offset_mm[0] - half : offset_mm[1] + half;
}

}  // namespace foci
