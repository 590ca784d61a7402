// The observer of a replay: gives samples and changed keys to a session, frame after frame.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "app/platform/warnings.h"
#include "app/replay/replay_inputs.h"
#include "app/session/frame_record.h"
#include "app/session/session.h"
#include "render/scene/scene.h"

namespace foci {

struct SeenFrame {
  FrameRecord record{};
  std::vector<glm::dvec2> gaze_px{};  ///< in the image, one for each view
  bool marker = false;                ///< the image shows where the observer looks
};

class ReplayedEye {
 public:
  /// @param gaze, scene, warnings  outlive it
  /// @throws InputError
  ReplayedEye(const Study& study, const ReplayedGaze& gaze, const Scene& scene, Warnings& warnings);

  /// Looks at the frame of the schedule after the last one, and renders it.
  /// @param seen  gets the frame's record
  /// @return until the next call
  const Frame& see(std::size_t frame, SeenFrame& seen);
  /// The same, but what the GPU renders may stay there.
  RenderedFrame& seeKept(std::size_t frame, SeenFrame& seen);

  /// Looks at a frame without rendering it. The frames after it are as if it had been rendered.
  /// @throws InputError as `requireParts`
  FrameRecord pass(std::size_t frame);

  /// @throws InputError if a frame depends on more than the requests before it: on the time that
  /// they took, or on their pixels
  void requireParts(std::size_t frame) const;

  /// @throws InputError if the head of a recording never has the scene in view, before minutes of
  /// an empty video
  void requireSceneInView(const Scene& scene) const;

  /// Says what renders, and warns if a live run's record began on another device.
  void sayDevice();
  /// After the frames: warns if the CPU rendered where the GPU was to.
  void addRemark();
  /// After all frames: warns if the record changed to other devices than the replay.
  void compareDevices();

  const Session& session() const { return session_; }
  FrameRenderer& renderer() { return session_.renderer(); }
  /// With the changes so far.
  const Study& study() const { return study_; }

 private:
  FrameRecord look(double time_s, double known_s);
  void warnOfRounding();
  const std::string& methodOf(std::size_t frame) const;
  void lookAtSkippedFrames();

  Study study_;
  const ReplayedGaze& gaze_;
  Warnings& warnings_;
  Session session_;
  std::size_t sample_ = 0, change_ = 0;  // next of each
};

}  // namespace foci
