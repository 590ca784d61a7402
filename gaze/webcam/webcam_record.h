// What a webcam tracker reads from one frame.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gaze/webcam/head_tracker.h"
#include "gaze/webcam/iris.h"

namespace foci {

/// Features of a frame, which a calibration maps to gaze.
/// The axes are those of the screen, as the observer sees it: x to the right, y up, z towards the
/// observer.
struct WebcamView {
  /// Offset of the iris from its place at rest, in widths of the eye; the mean of both eyes.
  glm::dvec2 eye{0.0};
  glm::dvec3 head_m{0.0, 0.0, 0.6};  ///< midpoint of the eyes, from the camera; z > 0
  glm::dvec2 head_rad{0.0};          ///< yaw to the right, pitch upwards
  double roll_rad = 0.0;             ///< of the head, clockwise as the observer feels it
};

/// The reference of the features: a view of the head, and the place of the eyes in it. With the
/// same reference and tracker, the features mean the same at another time.
struct WebcamReference {
  Lens camera;
  HeadView head;
  std::array<glm::dvec3, 2> eyes_mm{};  ///< irises of eyes at rest, left and right, head frame
  bool by_networks = false;             ///< the tracker that made it; else the cascades'
};

/// Why a frame has no gaze, or worse gaze. The first that applies, in this order.
enum class WebcamProblem {
  none,
  too_dark,
  no_face,
  glints,          ///< cover an iris
  one_eye_hidden,  ///< the gaze is that of the other eye
  too_far,         ///< irises of fewer than 8 pixels
  several_faces,   ///< one is followed: as before, else the largest
};

struct WebcamRecord {
  std::optional<WebcamView> view{};             ///< absent without a face and in a blink
  bool face = false;                            ///< a face is in view
  bool blink = false;                           ///< a face is in view and its eyes are shut
  double confidence = 0.0;                      ///< 0 to 1: share of right irises at this value
  std::array<std::optional<Iris>, 2> irises{};  ///< of the observer's left and right eye
  double ipd_px = 0.0;                          ///< interpupillary distance in the frame
  int faces = 0;                                ///< as many as were found last
  std::optional<HeadPose> head{};
  glm::dvec2 eyes_px{0.0};                           ///< midpoint of the eyes; with a face
  std::array<std::vector<glm::dvec2>, 2> lids_px{};  ///< closed outlines, for a picture
  WebcamProblem problem = WebcamProblem::none;
};

/// For people: "no face in view". @param ipd_px  of the face
std::string textOf(WebcamProblem problem, double ipd_px);

/// Counts frames with problems.
class WebcamProblems {
 public:
  void add(const WebcamRecord& record);
  /// Frames and text of each problem; of the size of irises it tells the mean.
  std::vector<std::pair<std::size_t, std::string>> list() const;

 private:
  struct Count {
    std::size_t frames = 0;
    double ipd_px = 0.0;  // sum
  };
  std::map<WebcamProblem, Count> counts_;
};

/// Radius of an average limbus (Hall et al. 1985).
inline constexpr double kLimbus_mm = 5.9;
/// An iris of a smaller diameter is too small for good gaze.
inline constexpr double kMinIris_px = 8.0;
/// Mean of an image, of 255, that is too dark for a face.
inline constexpr double kDark = 40.0;

/// Width of an average eye, between the corners; the unit of `WebcamView::eye`.
inline constexpr double kEyeWidth_mm = 30.0;

/// The features of a head and of the mean offset of its irises from their place at rest, from the
/// camera's axes to the screen's: x and y change their signs, z points back.
WebcamView webcamView(const HeadPose& pose, const glm::dvec2& offset_mm);

/// The mean offset of both irises. Where one is hidden, it is guessed from the other one's.
class MeanOffset {
 public:
  /// @param seen  one of them, or both
  glm::dvec2 of(const std::array<glm::dvec2, 2>& offset_mm, const std::array<bool, 2>& seen);
  void forget() { apart_mm_.reset(); }

 private:
  std::optional<glm::dvec2> apart_mm_;  // usual difference of left and right offset
};

}  // namespace foci
