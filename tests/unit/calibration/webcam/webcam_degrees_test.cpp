// Gaze in degrees: a person as hard to see as a real one is filmed, calibrated, and validated on
// other targets. The same map is fitted to the true irises, too: what then is left is the head's.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/webcam/webcam_calibration.h"
#include "tests/faces/hard_faces.h"
#include "tests/faces/observer.h"

namespace foci {
namespace {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.55};
const Lens kCamera{{.focal_px = {560, 560}, .principal_px = {320, 240}}};
constexpr std::size_t kFitTargets = 9, kTargets = 13, kFrames = 3;  // frames of each target

struct Condition {
  const char* name;
  bool glasses = false;
  double turn_rad = 0.03;
  bool leaves = false;  ///< half a minute before the validation, and sits down elsewhere
};

struct Errors {
  glm::dvec2 tracked_deg{0.0}, true_irises_deg{0.0}, mean_target_deg{0.0};
  double found = 0.0;  ///< share of the validation's frames
};

/// Nine targets to fit, from the centre in leaps, then four others.
std::vector<faces::ShownTarget> targets() {
  std::vector<faces::ShownTarget> shown;
  for (std::size_t i = 0; i < kTargets; ++i) {
    const int place = static_cast<int>(5 * i + 4) % 9, other = static_cast<int>(i - kFitTargets);
    const glm::dvec2 fit(0.23 * (place % 3 - 1), 0.12 * (1 - place / 3));
    const glm::dvec2 validation(other % 2 == 0 ? -0.12 : 0.12, other < 2 ? 0.06 : -0.06);
    const auto from_s = static_cast<double>(i);
    shown.push_back({from_s, from_s + 1.0, i < kFitTargets ? fit : validation});
  }
  return shown;
}

/// The view if the irises were found where they are.
WebcamView trueView(const WebcamRecord& record, const faces::Truth& truth) {
  glm::dvec2 sum(0.0);
  for (const glm::dvec2& px : truth.iris_px) {
    sum += glm::dvec2(onHeadPlane_mm(kCamera, *record.head, px, kIrisDepth_mm));
  }
  return webcamView(*record.head, 0.5 * sum);
}

glm::dvec2 meanError_deg(const std::vector<WebcamPair>& fit, const std::vector<WebcamPair>& other) {
  WebcamMap map;
  calibrateWebcam(fit, other, kScreen, map);
  glm::dvec2 sum(0.0);
  double count = 0.0;
  for (const WebcamPair& pair : other) {
    if (!pair.view) continue;
    const glm::dvec2 gaze_m = pointOnScreen_m(map, *pair.view);
    sum += glm::abs(glm::degrees(glm::atan(gaze_m / kScreen.distance_m)) - pair.target_deg);
    ++count;
  }
  return sum / count;
}

Errors measure(std::uint32_t index, const Condition& condition) {
  faces::Person person = faces::hardPerson(index);
  person.glasses = condition.glasses;
  const faces::Face face(person);
  const auto shown = targets();
  faces::Sitting sitting{.sway_rad = condition.turn_rad, .blink_every_s = 0.0, .seed = index + 1};
  WebcamTracker tracker(kCamera);
  std::array<std::vector<WebcamPair>, 2> tracked, exact;  // fit, validation
  Errors errors;
  glm::dvec2 mean_deg(0.0);
  for (std::size_t i = 0; i < kTargets; ++i) {
    const std::size_t part = i < kFitTargets ? 0 : 1;
    if (condition.leaves && i == kFitTargets) {
      const cv::Mat nobody(480, 640, CV_8UC3, cv::Scalar::all(90));
      for (int frame = 0; frame < 30; ++frame) tracker.push(nobody);
      sitting.head_m += glm::dvec3(0.03, -0.02, 0.04);
    }
    const faces::Observer observer(sitting, shown);
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      const double time_s = shown[i].from_s + 0.5 + 0.15 * static_cast<double>(frame);
      const faces::Moment moment = observer.at(time_s);
      const auto how = faces::hardLight(static_cast<std::uint32_t>(kFrames * i + frame));
      const WebcamRecord record = tracker.push(face.photograph(moment, how));
      const glm::dvec2 target_deg = glm::degrees(glm::atan(shown[i].point_m / kScreen.distance_m));
      tracked[part].push_back({record.view, time_s, target_deg});
      if (record.head) {
        exact[part].push_back({trueView(record, face.truthOf(moment, how)), time_s, target_deg});
      }
      if (part == 1) errors.found += record.view ? 1.0 / (kFrames * (kTargets - kFitTargets)) : 0.0;
    }
    if (part == 0) mean_deg += glm::degrees(glm::atan(shown[i].point_m / kScreen.distance_m)) / 9.0;
  }
  errors.tracked_deg = meanError_deg(tracked[0], tracked[1]);
  errors.true_irises_deg = meanError_deg(exact[0], exact[1]);
  for (const WebcamPair& pair : tracked[1]) {
    errors.mean_target_deg += glm::abs(pair.target_deg - mean_deg) / double(tracked[1].size());
  }
  return errors;
}

TEST(WebcamDegrees, AHardFaceIsFollowedThroughTheMap) {
  if (!FaceNetworks::missing().empty()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  const Errors errors = measure(1, {.name = ""});
  EXPECT_GT(errors.found, 0.9);
  // A third of the error of always guessing the middle of the screen.
  EXPECT_LT(errors.tracked_deg.x, errors.mean_target_deg.x / 3.0);
  EXPECT_LT(errors.tracked_deg.y, errors.mean_target_deg.y / 3.0);
}

/// For docs/results.py, which asks for disabled tests.
TEST(WebcamDegrees, DISABLED_Table) {
  constexpr std::array<std::uint32_t, 2> kPeople{1, 2};
  for (const Condition& condition :
       {Condition{.name = "usual"}, Condition{.name = "glasses", .glasses = true},
        Condition{.name = "turning_head", .turn_rad = 0.15},
        Condition{.name = "after_half_a_minute_out_of_view", .leaves = true}}) {
    std::array<glm::dvec2, 3> sum{};
    double found = 0.0;
    for (const std::uint32_t person : kPeople) {
      const Errors errors = measure(person, condition);
      sum[0] += errors.tracked_deg / double(kPeople.size());
      sum[1] += errors.true_irises_deg / double(kPeople.size());
      sum[2] += errors.mean_target_deg / double(kPeople.size());
      found += errors.found / double(kPeople.size());
    }
    std::string text = std::to_string(found);
    for (const glm::dvec2& each : sum) {
      text += " " + std::to_string(each.x) + " " + std::to_string(each.y);
    }
    RecordProperty(std::string("degrees_") + condition.name, text);
  }
}

}  // namespace
}  // namespace foci
