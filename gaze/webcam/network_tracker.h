// Follows a face by networks (face_networks.h).
#pragma once

#include "gaze/webcam/face_networks.h"
#include "gaze/webcam/webcam_record.h"

namespace foci {

class NetworkTracker {
 public:
  /// @param reference  holds a face's shape (asserted); absent: the first face becomes it
  NetworkTracker(FaceNetworks networks, const Lens& camera,
                 const std::optional<WebcamReference>& reference);

  /// @param image  BGR, 8 bits, without distortion
  WebcamRecord push(const cv::Mat& image);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

 private:
  void search(const cv::Mat& image);
  void begin(FaceMesh mesh);
  bool eyesAreGone() const;
  bool accept(const cv::Mat& image, const FaceMesh& mesh) const;
  bool showsEyes(const cv::Mat& image, const FaceMesh& mesh);
  bool updatePose();
  void readEyes(const cv::Mat& image, WebcamRecord& record);

  FaceNetworks networks_;
  Lens camera_;
  std::optional<FaceMesh> mesh_;  // of the face that is followed
  FaceShape shape_;               // empty before the first face
  int shape_frames_ = 0;          // averaged in `shape_`
  HeadPose pose_;
  bool new_face_ = true;
  int faces_ = 0;
  int frames_since_search_ = 0;
  bool showed_eyes_ = false;  // both at once
  int frames_without_eyes_ = 0;
  std::array<double, 2> usual_opening_{};  // 0: not known
  MeanOffset mean_offset_;
};

}  // namespace foci
