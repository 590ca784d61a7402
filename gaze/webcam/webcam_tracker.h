// From a webcam's frames to features of the observer: one record for each frame.
#pragma once

#include <array>
#include <optional>

#include "gaze/webcam/face_finder.h"
#include "gaze/webcam/head_tracker.h"
#include "gaze/webcam/iris.h"
#include "gaze/webcam/straight_frames.h"
#include "gaze/webcam/webcam_view.h"

namespace foci {

/// The reference of the features: a view of the head, and the place of the eyes in it. With the
/// same reference, the features mean the same at another time.
struct WebcamReference {
  Lens camera;
  HeadView view;
  std::array<glm::dvec3, 2> eyes_mm{};  ///< irises of eyes at rest, left and right, head frame
};

struct WebcamRecord {
  std::optional<WebcamView> view{};             ///< absent without a face and in a blink
  bool face = false;                            ///< a face is in view
  bool blink = false;                           ///< a face is in view and its eyes are shut
  double confidence = 0.0;                      ///< 0 to 1
  std::array<std::optional<Iris>, 2> irises{};  ///< of the observer's left and right eye
  double ipd_px = 0.0;                          ///< interpupillary distance in the frame
};

class WebcamTracker {
 public:
  /// @param camera     absent: the reference's camera, else a usual webcam
  /// @param reference  of a calibration; absent: the first face becomes the reference
  /// @throws InputError if the cascades are not installed
  explicit WebcamTracker(const std::optional<Lens>& camera = std::nullopt,
                         const std::optional<WebcamReference>& reference = std::nullopt);

  /// @param image  8 bits, one channel; all of one size, in the order of time
  /// @throws InputError if the frame has another size than the camera was calibrated for
  WebcamRecord push(const cv::Mat& image);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

 private:
  void prepare(const cv::Mat& image);
  std::optional<double> locateHead(const cv::Mat& grey);
  bool findHead(const cv::Mat& grey);
  void readIrises(const cv::Mat& grey, WebcamRecord& record);
  std::optional<Iris> findIris(const cv::Mat& grey, std::size_t eye) const;
  glm::dvec2 meanOffset_mm(const WebcamRecord& record);
  WebcamView viewOf(const glm::dvec2& offset_mm) const;

  std::optional<Lens> camera_;
  std::optional<StraightFrames> straight_{};
  std::optional<WebcamReference> given_;
  FaceFinder finder_;
  std::optional<HeadTracker> head_;
  std::array<glm::dvec3, 2> eyes_mm_{};
  bool following_ = false;
  int frames_without_head_ = 0;
  int failures_ = 0;  // to find the same head again
  std::array<double, 2> usual_contrast_{};
  std::array<double, 2> radius_mm_{};
  std::array<glm::dvec2, 2> offset_mm_{};  // latest offset of each iris from its place at rest
  glm::dvec2 apart_mm_{0.0};               // usual difference of left and right offset
  bool know_apart_ = false;                // `apart_mm_` belongs to this head
};

}  // namespace foci
