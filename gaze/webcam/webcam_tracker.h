// A webcam's frames to what they say of the observer: one record a frame.
#pragma once

#include <array>
#include <optional>

#include "gaze/webcam/face_finder.h"
#include "gaze/webcam/head_tracker.h"
#include "gaze/webcam/iris.h"
#include "gaze/webcam/straight_frames.h"
#include "gaze/webcam/webcam_view.h"

namespace foci {

/// What must be known of an observer for the features to mean the same at another time: a view of
/// the head, and where in it the eyes are.
struct WebcamReference {
  Lens camera;
  HeadView view;
  std::array<glm::dvec3, 2> eyes_mm{};  ///< irises of eyes at rest, head frame; left, right
};

struct WebcamRecord {
  std::optional<WebcamView> view{};             ///< absent without a face and in a blink
  bool face = false;                            ///< one is in view
  bool blink = false;                           ///< the face is, its eyes are shut
  double confidence = 0.0;                      ///< 0 to 1
  std::array<std::optional<Iris>, 2> irises{};  ///< of the observer's left and right eye
  double ipd_px = 0.0;
};

class WebcamTracker {
 public:
  /// @param camera     absent: that of the reference, else a usual webcam
  /// @param reference  of a calibration, whose features these should be; else the first face is it
  /// @throws InputError where the cascades are not installed
  explicit WebcamTracker(const std::optional<Lens>& camera = std::nullopt,
                         const std::optional<WebcamReference>& reference = std::nullopt);

  /// @param image  8 bits, one channel; frames of one size, in the order of time
  /// @throws InputError on frames of another size than the camera was calibrated for
  WebcamRecord push(const cv::Mat& image);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

 private:
  bool findHead(const cv::Mat& grey);
  std::optional<Iris> findIris(const cv::Mat& grey, std::size_t eye) const;

  std::optional<Lens> camera_;
  std::optional<StraightFrames> straight_{};
  std::optional<WebcamReference> given_;
  FaceFinder finder_;
  std::optional<HeadTracker> head_;
  std::array<glm::dvec3, 2> eyes_mm_{};
  bool following_ = false;
  int frames_lost_ = 0;
  int failures_ = 0;  // of taking up the head again
  std::array<double, 2> usual_contrast_{};
  std::array<double, 2> radius_mm_{};
  std::array<glm::dvec2, 2> offset_mm_{};  // of the iris from the eye at rest, last seen
  glm::dvec2 apart_mm_{0.0};               // left minus right offset, usual
  bool know_apart_ = false;
};

}  // namespace foci
