#include "gaze/webcam/webcam_source.h"

#include <algorithm>
#include <chrono>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
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

const cv::Mat& StraightFrames::of(const cv::Mat& frame) {
  const auto text = [](int x, int y) { return std::to_string(x) + "x" + std::to_string(y); };
  if (lens_.size_px.x > 0 && lens_.size_px != glm::ivec2(frame.cols, frame.rows)) {
    throw InputError("webcam", "frames of " + text(frame.cols, frame.rows) +
                                   " px: the camera was calibrated at " +
                                   text(lens_.size_px.x, lens_.size_px.y) + ", expected the same");
  }
  if (std::ranges::all_of(lens_.distortion, [](double k) { return k == 0.0; })) {
    return frame;
  }
  if (from_.empty()) {
    // OpenCV counts pixel centres from 0.
    const cv::Matx33d pinhole(lens_.focal_px.x, 0.0, lens_.principal_px.x - 0.5, 0.0,
                              lens_.focal_px.y, lens_.principal_px.y - 0.5, 0.0, 0.0, 1.0);
    const cv::Mat distortion(1, 5, CV_64F, lens_.distortion.data());
    cv::initUndistortRectifyMap(pinhole, distortion, cv::noArray(), pinhole, frame.size(), CV_16SC2,
                                from_, weights_);
  }
  cv::remap(frame, straight_, from_, weights_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return straight_;
}

WebcamTracker::WebcamTracker(const std::optional<Lens>& camera,
                             const std::optional<WebcamReference>& reference)
    : camera_(camera),
      given_(reference),
      networks_(FaceNetworks::load()),
      by_networks_(networks_.has_value()) {
  if (!reference) return;
  if (!camera) camera_ = reference->camera;
  if (by_networks_ == reference->by_networks) return;
  throw InputError("webcam",
                   by_networks_
                       ? "the map was calibrated without the networks that follow the face now: "
                         "calibrate again (foci calibrate gaze)"
                       : "the map was calibrated with networks that are not installed here: get "
                         "them (sh app/webcam_models.sh), or calibrate again");
}

std::optional<WebcamReference> WebcamTracker::reference() const {
  if (!tracker_) return std::nullopt;
  return std::visit([](const auto& tracker) { return tracker.reference(); }, *tracker_);
}

std::string WebcamTracker::remark() const {
  if (by_networks_) return "";
  return "the webcam's networks are not installed (sh app/webcam_models.sh gets them): a simpler "
         "tracker serves, which needs good light and a first frame that looks straight ahead";
}

WebcamRecord WebcamTracker::push(const cv::Mat& image) {
  if (!tracker_) {
    const glm::ivec2 size_px(image.cols, image.rows);
    if (!camera_) camera_ = Lens{usualPinhole(size_px), {}, size_px};
    straight_.emplace(*camera_);
    if (networks_) {
      tracker_.emplace(NetworkTracker(std::move(*networks_), *camera_, given_));
      networks_.reset();
    } else {
      tracker_.emplace(CascadeTracker(*camera_, given_));
    }
  }
  const cv::Mat& straight = straight_->of(image);
  cv::Mat wanted = straight;
  const int channels = by_networks_ ? 3 : 1;
  if (straight.channels() != channels) {
    cv::cvtColor(straight, wanted, channels == 1 ? cv::COLOR_BGR2GRAY : cv::COLOR_GRAY2BGR);
  }
  return std::visit([&](auto& tracker) { return tracker.push(wanted); }, *tracker_);
}

}  // namespace foci
