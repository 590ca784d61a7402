#include "gaze/webcam/webcam_source.h"

#include <chrono>
#include <opencv2/core.hpp>
#include <utility>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr std::size_t kMaxKept = 600;  // frames that wait for `takeFrames`
constexpr std::chrono::milliseconds kMaxPoll{500};

}  // namespace

GazeSample sampleOf(const WebcamFrame& frame, const WebcamMapping& map) {
  GazeSample sample{
      .time_s = frame.time_s, .blink = frame.record.blink, .confidence = frame.record.confidence};
  if (frame.record.view && map) {
    const WebcamGaze gaze = map(*frame.record.view);
    sample.point_px = gaze.point_px;
    sample.uncertainty_deg = gaze.uncertainty_deg;
  }
  return sample;
}

WebcamRecording readWebcam(const WebcamPlace& place, WebcamTracker& tracker) {
  WebcamFrames frames(place);
  if (frames.isCamera())
    throw InputError(nameOf(place), "expected a recording: a camera never ends");
  WebcamRecording recording;
  WebcamProblems problems;
  for (cv::Mat image; const auto time_s = frames.nextTime_s();) {
    if (!frames.next(image)) break;
    recording.frames.push_back({*time_s, tracker.push(image)});
    problems.add(recording.frames.back().record);
  }
  if (recording.frames.empty()) {
    throw InputError(nameOf(place), "has no frame that can be read");
  }
  for (const std::string& remark : {tracker.remark(), frames.remark()}) {
    if (!remark.empty()) recording.warnings.push_back(remark);
  }
  for (const auto& [count, text] : problems.list()) {
    recording.warnings.push_back(std::to_string(count) + " of " +
                                 std::to_string(recording.frames.size()) + " frames: " + text);
  }
  return recording;
}

WebcamSource::WebcamSource(const WebcamPlace& place, WebcamTracker tracker, WebcamMapping map)
    : place_(place), frames_(place), tracker_(std::move(tracker)), map_(std::move(map)) {}

void WebcamSource::poll(double now_s, std::vector<GazeSample>& samples) {
  if (!first_s_) first_s_ = now_s;
  const auto begin = std::chrono::steady_clock::now();
  cv::Mat image;
  while (!ended_) {
    // A file's frame is due at its time. A camera's frame is due when it has arrived.
    const bool camera = frames_.isCamera();
    const auto next_s = camera ? std::optional(0.0) : frames_.nextTime_s();
    const double due_s = *first_s_ + next_s.value_or(0.0);
    if (!camera && next_s && due_s > now_s) break;
    if (!next_s || !frames_.next(image)) {
      ended_ = !camera;
      break;
    }
    // A machine too slow for a file's rate loses frames, as it would of a camera.
    if (!camera && std::chrono::steady_clock::now() - begin > kMaxPoll) continue;
    const WebcamFrame frame{camera ? now_s : due_s, tracker_.push(image)};
    problem_ = textOf(frame.record.problem, frame.record.ipd_px);
    if (recent_.size() == kMaxKept) recent_.erase(recent_.begin());
    recent_.push_back(frame);
    if (last_s_ && frame.time_s <= *last_s_) continue;  // a camera gave two frames in one poll
    last_s_ = frame.time_s;
    samples.push_back(sampleOf(frame, map_));
  }
}

std::vector<WebcamFrame> WebcamSource::takeFrames() { return std::exchange(recent_, {}); }

std::string WebcamSource::status() const {
  return nameOf(place_) +
         (ended_             ? ", ended"
          : problem_.empty() ? ""
                             : ", " + problem_) +
         (map_ ? "" : ", not calibrated: foci calibrate gaze --source webcam");
}

}  // namespace foci
