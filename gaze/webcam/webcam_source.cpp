#include "gaze/webcam/webcam_source.h"

#include <opencv2/core.hpp>
#include <utility>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr std::size_t kMaxKept = 600;  // frames that wait for `takeFrames`

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

std::vector<WebcamFrame> readWebcam(const WebcamPlace& place, WebcamTracker& tracker) {
  WebcamFrames frames(place);
  if (frames.isCamera())
    throw InputError(nameOf(place), "expected a recording: a camera never ends");
  std::vector<WebcamFrame> all;
  for (cv::Mat image; frames.next(image);) {
    all.push_back({static_cast<double>(all.size()) / frames.rate_Hz(), tracker.push(image)});
  }
  if (all.empty()) throw InputError(nameOf(place), "has no frame that can be read");
  return all;
}

WebcamSource::WebcamSource(const WebcamPlace& place, WebcamTracker tracker, WebcamMapping map)
    : place_(place), frames_(place), tracker_(std::move(tracker)), map_(std::move(map)) {}

void WebcamSource::poll(double now_s, std::vector<GazeSample>& samples) {
  if (!first_s_) first_s_ = now_s;
  cv::Mat image;
  while (!ended_) {
    // A file's frame is due at its time. A camera's frame is due when it has arrived.
    const double due_s = *first_s_ + static_cast<double>(count_) / frames_.rate_Hz();
    if (!frames_.isCamera() && due_s > now_s) break;
    if (!frames_.next(image)) {
      ended_ = !frames_.isCamera();
      break;
    }
    ++count_;
    const WebcamFrame frame{frames_.isCamera() ? now_s : due_s, tracker_.push(image)};
    problem_ = frame.record.problem;
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
         (ended_                            ? ", ended"
          : problem_ == WebcamProblem::none ? ""
                                            : ", " + std::string(textOf(problem_))) +
         (map_ ? "" : ", not calibrated: foci calibrate gaze --source webcam");
}

}  // namespace foci
