// A headset by OpenXR 1.0: a display for both eyes, and a source of poses and of gaze. Lengths are
// metres. Frames of reference are right-handed, x right, y up, looking along -z: `local`, the
// room's, whose origin the runtime sets; `head`; `eye`, along its display's axis. Times are seconds
// of std::chrono::steady_clock.
#pragma once

#include <atomic>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "render/gl/device.h"

namespace foci {

struct HeadsetFacts {
  std::string runtime, headset;
  std::string no_gaze{};   ///< why there is no gaze; empty: there is
  bool asks_gaze = false;  ///< `Headset::gaze` asks for it; runtimes have denied trackers they had
  glm::ivec2 eye_px{0};    ///< image of one eye that the runtime recommends; even numbers
  HeadsetEyes eyes{};
  double period_s = 0.0;  ///< of its frames, at first
};

/// The frame that the runtime asks for.
struct HeadsetTick {
  double display_s = 0.0, period_s = 0.0;  ///< as predicted
  bool shows = false;                      ///< false: the runtime shows nothing now
};

struct HeadNow {
  HeadInWorld head{};      ///< in the local frame
  double display_s = 0.0;  ///< time for which it is predicted
};

/// What both eyes see, side by side, as display codes (sRGB), with the first row at the top.
struct HeadsetPicture {
  unsigned texture = 0;                ///< 8 bits a channel; 0: `rgb`
  const unsigned char* rgb = nullptr;  ///< rows without padding
  glm::ivec2 size_px{0};
  std::vector<glm::dvec2> markers_px{};  ///< gaze markers, which the picture lacks
  bool fixates = false;                  ///< else their rings are broken
  HeadInWorld head{};                    ///< in the local frame, as rendered
  HeadsetEyes eyes{};                    ///< as rendered
};

struct HeadsetGaze {
  double time_s = 0.0;
  bool own_time = false;                  ///< the runtime states when it was measured
  std::optional<glm::dvec3> direction{};  ///< unit, in the head's frame; absent: in a blink or lost
  bool degraded = false;                  ///< predicted or inferred, not tracked
  HeadInWorld head{};                     ///< at that time, in the local frame
};

/// The session has ended without our doing, or has failed.
class HeadsetLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Headset {
 public:
  /// Opens runtime, headset and session, and learns where its displays are.
  /// @param context  is the session's alone; current in this thread during each call but `headNext`
  ///   and `gaze`
  /// @param loader   of OpenXR
  /// @throws InputError which says what is missing; HeadsetLost
  explicit Headset(std::unique_ptr<GpuContext> context, const std::string& loader = "");
  /// Ends the session. The thread then has the context that it had before.
  ~Headset();
  Headset& operator=(Headset&&) = delete;  // nor copied

  const HeadsetFacts& facts() const { return facts_; }
  GpuContext& context() { return *context_; }

  /// Handles what has happened, and waits for the next frame. Each frame is submitted.
  /// @return absent: the session does not run yet, or no longer
  /// @throws HeadsetLost
  std::optional<HeadsetTick> waitFrame();

  /// Shows a picture in the frame of the last `waitFrame`.
  /// @param picture  null: the last one again
  /// @throws HeadsetLost
  void submit(const HeadsetPicture* picture);

  /// The displays, as they are now: an observer may turn the wheel of the pupil distance.
  HeadsetEyes eyesNow();

  // Any thread may:
  /// The head in the frame after the one that is asked for; absent while it is not tracked.
  std::optional<HeadNow> headNext() const;
  /// The newest gaze; absent while the session does not run or the tracker is off.
  std::optional<HeadsetGaze> gaze() const;
  /// Whether the runtime or the observer has ended the session.
  bool ended() const { return ended_; }

 private:
  struct Parts;
  void poll();

  std::unique_ptr<GpuContext> context_;
  std::unique_ptr<Parts> parts_;
  HeadsetFacts facts_;
  std::atomic<bool> ended_ = false;
};

}  // namespace foci
