// Follows a face without networks. The boosted cascades of Viola and Jones (2001), from Debian's
// package opencv-data, find faces and eyes; the pair of irises is taken that suits a face best. The
// face's patches are followed from frame to frame, and a disk is fitted to each iris. The tracker
// needs a first frame in which the face looks straight ahead, and good light.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "gaze/webcam/head_tracker.h"
#include "gaze/webcam/iris.h"
#include "gaze/webcam/webcam_record.h"

namespace cv {
class Mat;
}

namespace foci {

class FaceFinder {
 public:
  /// @throws InputError if the cascades are not installed
  FaceFinder();
  ~FaceFinder();
  FaceFinder(FaceFinder&& other) noexcept;

  /// Finds a face that is at least an eighth of the image wide and has open eyes.
  /// @param grey  8 bits, one channel
  /// @return centres of the irises, px. Index 0 is the observer's left eye, at the image's right
  std::optional<std::array<glm::dvec2, 2>> find(const cv::Mat& grey);

 private:
  struct Cascades;
  std::unique_ptr<Cascades> cascades_;
};

class CascadeTracker {
 public:
  /// @param reference  of this tracker; absent: the first face becomes it
  /// @throws InputError if the cascades are not installed
  CascadeTracker(const Lens& camera, const std::optional<WebcamReference>& reference);

  /// @param grey  8 bits, one channel, without distortion
  WebcamRecord push(const cv::Mat& grey);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

 private:
  std::optional<double> locateHead(const cv::Mat& grey);
  bool findHead(const cv::Mat& grey);
  void readIrises(const cv::Mat& grey, WebcamRecord& record);
  std::optional<Iris> findIris(const cv::Mat& grey, std::size_t eye) const;

  Lens camera_;
  HeadTracker head_;
  std::optional<WebcamReference> given_;
  FaceFinder finder_;
  std::array<glm::dvec3, 2> eyes_mm_{};
  bool following_ = false;
  int frames_without_head_ = 0;
  int failures_ = 0;  // to find the same head again
  std::array<double, 2> usual_contrast_{};
  std::array<double, 2> radius_mm_{};
  std::array<glm::dvec2, 2> offset_mm_{};  // latest offset of each iris from its place at rest
  MeanOffset mean_offset_;
};

}  // namespace foci
