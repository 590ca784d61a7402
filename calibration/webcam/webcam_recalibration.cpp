#include "calibration/webcam/webcam_recalibration.h"

#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace {

// Chosen by hand: some hundreds of samples count as one or two clicks. The test
// WebcamRecalibration.LearnsFromEachClickOnceEyesAreSeen bounds it.
constexpr double kCalibrationShare = 0.005;
constexpr std::size_t kMaxClicks = 30;  // chosen by hand; older ones may be of another posture
constexpr std::chrono::milliseconds kMaxAge{300};  // about the duration of one fixation

}  // namespace

WebcamGaze WebcamRecalibration::gazeOf(const WebcamView& view) {
  WebcamMap map;
  {
    const std::lock_guard lock(mutex_);
    seen_ = {view, std::chrono::steady_clock::now()};
    map = map_;
  }
  return mappingOf(map, screen_)(view);
}

bool WebcamRecalibration::click(const glm::dvec2& point_px) {
  std::vector<WebcamSample> clicks;
  {
    const std::lock_guard lock(mutex_);
    if (!seen_ || std::chrono::steady_clock::now() - seen_->at > kMaxAge) return false;
    const glm::dvec2 m_per_px = screen_.size_m / glm::dvec2(screen_.size_px);
    const glm::dvec2 from_middle_m = (point_px - 0.5 * glm::dvec2(screen_.size_px)) * m_per_px;
    if (clicks_.size() == kMaxClicks) clicks_.erase(clicks_.begin());
    clicks_.push_back({seen_->view, {from_middle_m.x, -from_middle_m.y}});
    clicks = clicks_;
  }
  const WebcamMap fitted = fitWebcamMap(clicks, calibrated_, kCalibrationShare);
  const std::lock_guard lock(mutex_);
  map_ = fitted;
  return true;
}

}  // namespace foci
