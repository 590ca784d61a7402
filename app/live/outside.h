// The scene from outside, in the window of `foci live`: the head and its path, the line of sight
// and the fixations. A camera of its own sees it. The observer's frames do not depend on it.
#pragma once

#include <deque>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "app/graphics/image.h"
#include "app/live/pose.h"
#include "app/live/refiner.h"
#include "app/live/renderer.h"
#include "app/session/frame_record.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// What the observer has done in the latest frames.
class ObserverTrail {
 public:
  struct Fixation {
    glm::dvec3 point_m{0.0};  ///< on the surface, mean
    double from_s = 0.0, to_s = 0.0;
    int frames = 0;
  };

  /// @param screen  of the record's points
  void add(const FrameRecord& record, const Screen& screen);

  const std::deque<glm::dvec3>& path_m() const { return path_m_; }
  const std::deque<Fixation>& fixations() const { return fixations_; }
  /// The end of the line of sight: on the surface in a fixation, else where the eye focuses.
  /// Absent: no gaze.
  const std::optional<glm::dvec3>& looksAt_m() const { return looks_at_m_; }

 private:
  std::deque<glm::dvec3> path_m_;
  std::deque<Fixation> fixations_;
  std::optional<glm::dvec3> looks_at_m_;
  bool fixates_ = false;
};

/// Where a view shows a line. Absent: behind the camera.
std::optional<std::pair<glm::vec2, glm::vec2>> lineInView_px(const View& view, glm::dvec3 from_m,
                                                             glm::dvec3 to_m);

/// Where the camera begins: behind the observer, to the right and above. It faces the middle of the
/// line of sight.
LivePose cameraBehind(const FrameRecord& record, const glm::dvec3& up);

class OutsideView {
 public:
  /// @param camera  its first pose
  OutsideView(OutsideScene&& scene, const LivePose& camera);

  /// Has a thread render what the camera sees now. Does not wait.
  void update(const glm::ivec2& size_px);

  LiveSteering& camera() { return camera_; }
  /// The newest that has been rendered; null: none yet.
  const std::shared_ptr<const Image>& image() const { return image_; }
  const View& view() const { return view_; }  ///< of the image

 private:
  LiveSteering camera_;
  RenderRequest request_;
  std::shared_ptr<const Image> image_;
  View view_;
  bool asked_ = false;  // for `request_`, which is not rendered yet
  Refiner refiner_;
};

}  // namespace foci
