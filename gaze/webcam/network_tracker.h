// Follows a face by networks (face_networks.h). The mesh tells where the face is and, roughly, its
// pose. Patches of the face (head_tracker.h) measure its turns to a fraction of a degree.
#pragma once

#include "gaze/webcam/face_networks.h"
#include "gaze/webcam/webcam_record.h"

namespace foci {

class NetworkTracker {
 public:
  /// @param reference  of this tracker; absent: the first face becomes it
  NetworkTracker(FaceNetworks networks, const Lens& camera,
                 const std::optional<WebcamReference>& reference);

  /// @param image  BGR, 8 bits, without distortion
  WebcamRecord push(const cv::Mat& image);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

 private:
  void search(const cv::Mat& image, bool in_doubt);
  void begin(FaceMesh mesh);
  bool eyesAreGone() const;
  bool accept(const cv::Mat& image, const FaceMesh& mesh) const;
  bool updatePose(const cv::Mat& grey);
  void learnPose(const cv::Mat& grey);
  WebcamRecord read(const cv::Mat& image);
  void readEyes(const cv::Mat& image, const cv::Mat& grey, WebcamRecord& record);

  FaceNetworks networks_;
  Lens camera_;
  std::optional<FaceMesh> mesh_;  // of the face that is followed
  HeadTracker head_;
  std::array<glm::dvec3, 2> eyes_mm_{};
  HeadPose pose_;
  HeadPose mesh_pose_;  // of this frame, as the mesh shows it
  /// The pose by the mesh, seen from the pose by the patches: the mean of recent frames.
  glm::dmat3 mesh_turn_{1.0};
  glm::dvec3 mesh_shift_mm_{0.0};
  int compared_ = 0;        // frames in that mean
  bool following_ = false;  // the patches were found in this frame
  int misses_ = 0;          // to find them, in a row
  int faces_ = 0;
  int frames_since_search_ = 0;
  bool shows_both_ = false;   // eyes, in the latest frame
  bool showed_eyes_ = false;  // both at once, since the face was found
  int frames_without_eyes_ = 0;
  std::array<double, 2> usual_opening_{};  // 0: not known
  MeanOffset mean_offset_;
};

}  // namespace foci
